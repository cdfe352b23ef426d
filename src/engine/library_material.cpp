// Reading and changing the materials of an open scene.
#include "base/check.h"
#include "engine/library.h"
#include "engine/recolor.h"

namespace pocketray {
namespace {

Status check_material(const pocketray_instance* instance, std::uint32_t material) {
  RETURN_IF_ERROR(check_instance(instance));
  const std::uint32_t count = instance->renderer.scene.materials.count;
  if (material < count) return success();
  return failure("there is no material %u: the scene has %u, counted from 0", material, count);
}

pocketray_material to_caller(const Material& m) {
  pocketray_material result = POCKETRAY_MATERIAL_INIT;
  from_vec3(m.diffuse, result.diffuse);
  from_vec3(m.specular, result.specular);
  from_vec3(m.mirror, result.mirror);
  from_vec3(m.specular_tinted, result.specular_tinted);
  from_vec3(m.mirror_tinted, result.mirror_tinted);
  from_vec3(m.transmission, result.transmission);
  from_vec3(m.absorption, result.absorption);
  from_vec3(m.emission, result.emission);
  result.texture = m.diffuse_texture.texture;
  return result;
}

// Changes only what the caller's structure describes.
void from_caller(const pocketray_material& given, Material* m) {
  m->diffuse = to_vec3(given.diffuse);
  m->specular = to_vec3(given.specular);
  m->mirror = to_vec3(given.mirror);
  m->specular_tinted = to_vec3(given.specular_tinted);
  m->mirror_tinted = to_vec3(given.mirror_tinted);
  m->transmission = to_vec3(given.transmission);
  m->absorption = to_vec3(given.absorption);
  m->emission = to_vec3(given.emission);
  m->diffuse_texture.texture = given.texture;
}

}  // namespace
}  // namespace pocketray

using namespace pocketray;

pocketray_result pocketray_get_material(const pocketray_instance* instance, std::uint32_t material,
                                        pocketray_material* result) {
  const Status status = check_material(instance, material);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  const pocketray_material read = to_caller(instance->renderer.scene.materials[material]);
  return to_result(write_struct("the material", read, result), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_set_material(pocketray_instance* instance, std::uint32_t material,
                                        const pocketray_material* changed) {
  Status status = check_material(instance, material);
  pocketray_material given = POCKETRAY_MATERIAL_INIT;
  if (status.ok) status = read_struct("the material", changed, &given);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  Renderer* renderer = &instance->renderer;
  CHECK_LT(material, renderer->scene.materials.count);
  Material recolored = renderer->scene.materials[material];
  from_caller(given, &recolored);
  status = check_recolorable(*renderer);
  if (!status.ok) return refuse(POCKETRAY_ERROR_LIMIT, status);
  status = check_recolored(renderer, material, recolored);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  status = change_material(renderer, material, recolored);
  if (!status.ok) return refuse(POCKETRAY_ERROR_LIMIT, status);
  instance->refining = false;
  return POCKETRAY_OK;
}
