#include "engine/recolor.h"

#include <cstring>

#include "base/check.h"
#include "effect/effect_list.h"
#include "plan/plan_effects.h"
#include "scene/metallic_roughness.h"
#include "scene/validate_checks.h"

namespace pocketray {
namespace {

bool has_other_lobes(const Material& a, const Material& b) {
  return a.diffuse != b.diffuse || a.specular != b.specular || a.specular_tinted != b.specular_tinted ||
         a.mirror != b.mirror || a.mirror_tinted != b.mirror_tinted || a.transmission != b.transmission;
}

}  // namespace

void make_recolorable(Renderer* renderer) {
  CHECK(renderer->materials.current.empty());  // it has not been built before
  renderer->materials.opened = renderer->scene.materials;
  if (recolorable_count(*renderer) == 0) return;
  renderer->materials.current = arena_array<Material>(&renderer->memory.persistent, renderer->scene.materials.count);
  std::memcpy(static_cast<void*>(renderer->materials.current.data), renderer->scene.materials.data,
              renderer->materials.current.bytes());
  renderer->scene.materials = renderer->materials.current;
}

Status check_recolorable(const Renderer& renderer) {
  if (renderer.materials.current.count) return success();
  return failure("no memory is reserved for changing materials: open with recolorable");
}

Status check_recolored(Renderer* renderer, std::uint32_t index, const Material& material) {
  CHECK_LT(index, renderer->materials.current.count);
  const Scene& scene = renderer->scene;
  CHECK(scene.materials.data == renderer->materials.current.data);
  if (((scene.material_maps.count && has_lobe_map(scene.material_maps[index])) || glass_map_of(scene, index)) &&
      has_other_lobes(renderer->materials.current[index], material))
    return failure(
        "materials[%u]: a texture makes its diffuse, specular, mirror and transmission: change its colour texture",
        index);
  const Material before = renderer->materials.current[index];
  renderer->materials.current[index] = material;
  const Status status = validate_material(scene, index);
  renderer->materials.current[index] = before;
  return status;
}

Status change_material(Renderer* renderer, std::uint32_t index, const Material& material) {
  RETURN_IF_ERROR(check_recolorable(*renderer));
  CHECK_LT(index, renderer->materials.current.count);
  CHECK_EQ(renderer->materials.opened.count, renderer->materials.current.count);
  if (is_zero(renderer->materials.opened[index].emission) && !is_zero(material.emission))
    return failure("materials[%u] emits nothing in the scene: let it emit there, however little", index);
  // Includes effects of other texture filters, which may be set later.
  Settings settings = renderer->settings;
  settings.texture_filter = TextureFilter::as_scene;
  const Material before = renderer->materials.current[index];
  const EffectMask planned = plan_effects(opened_scene(*renderer), settings).mask;
  renderer->materials.current[index] = material;
  const EffectMask called_for = plan_effects(renderer->scene, settings).mask & ~planned;
  if (called_for) {
    renderer->materials.current[index] = before;
    const char* name = kEffectList[__builtin_ctzll(called_for)].name;
    return failure("materials[%u] calls for the effect %s, the scene as opened does not: open with effects auto,%s",
                   index, name, name);
  }
  recolor(&renderer->history.coherence, index, before, material, renderer->scene);
  renderer->lights.lit_mask = ~EffectMask(0);  // place lights again
  return success();
}

}  // namespace pocketray
