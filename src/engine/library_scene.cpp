// Reading and changing an open scene between frames.
#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"
#include "engine/frame.h"
#include "engine/library.h"
#include "scene/validate_checks.h"

namespace pocketray {
namespace {

Status check_changing(const pocketray_instance* instance, const char* name, const void* argument) {
  RETURN_IF_ERROR(check_instance(instance));
  if (argument) return success();
  return failure("%s: a null pointer", name);
}

Status check_radiance(const char* name, const float* rgb) {
  for (int channel = 0; channel < 3; ++channel)
    if (!(rgb[channel] >= 0 && rgb[channel] <= kRadianceMax))
      return failure("%s[%d] is %g: it must lie in 0 … %g", name, channel, static_cast<double>(rgb[channel]),
                     static_cast<double>(kRadianceMax));
  return success();
}

pocketray_light to_caller(const Light& light) {
  pocketray_light result = POCKETRAY_LIGHT_INIT;
  result.kind = static_cast<int>(light.kind);
  from_vec3(light.position, result.position);
  from_vec3(light.direction, result.direction);
  from_vec3(light.intensity, result.intensity);
  result.range = light.range;
  result.cos_inner = light.cos_inner;
  result.cos_outer = light.cos_outer;
  result.node = light.node;
  return result;
}

Light from_caller(const pocketray_light& light) {
  Light result;
  result.kind = static_cast<LightKind>(light.kind);
  result.position = to_vec3(light.position);
  result.direction = to_vec3(light.direction);
  result.intensity = to_vec3(light.intensity);
  result.range = light.range;
  result.cos_inner = light.cos_inner;
  result.cos_outer = light.cos_outer;
  result.node = light.node;
  return result;
}

pocketray_result change_lights(pocketray_instance* instance, const pocketray_light* lights, std::uint32_t count) {
  CHECK_LE(count, instance->posed_lights.count);
  Renderer* renderer = &instance->renderer;
  Array<Light> changed = {instance->posed_lights.data, count};  // refilled for every frame
  for (std::uint32_t i = 0; i < count; ++i) changed[i] = from_caller(lights[i]);
  const Array<const Light> before = renderer->scene.lights;
  renderer->scene.lights = changed;
  Status status = validate_lights_and_cameras(renderer->scene);
  pocketray_result result = to_result(status, POCKETRAY_ERROR_ARGUMENT);
  if (result == POCKETRAY_OK) result = to_result(plan_again(instance, renderer->settings), POCKETRAY_ERROR_LIMIT);
  renderer->scene.lights = before;
  if (result != POCKETRAY_OK) return result;
  if (count) std::memcpy(static_cast<void*>(instance->lights.data), changed.data, changed.bytes());
  renderer->scene.lights = {instance->lights.data, count};
  if (renderer->pose.nodes.count) renderer->pose.lights.count = count;
  return POCKETRAY_OK;
}

Status check_node(const pocketray_instance* instance, std::uint32_t node) {
  std::uint32_t count = instance->renderer.scene.nodes.count;
  if (node < count) return success();
  return failure("there is no node %u: the scene has %u", node, count);
}

Transform to_transform(const float* rows) {
  Transform t;
  std::memcpy(t.m, rows, sizeof t.m);
  return t;
}

}  // namespace
}  // namespace pocketray

using namespace pocketray;

#define REFUSE_IF_ERROR(result, expression)                          \
  do {                                                               \
    Status checked_status = (expression);                            \
    if (!checked_status.ok) return refuse((result), checked_status); \
  } while (0)

pocketray_result pocketray_get_settings(const pocketray_instance* instance, pocketray_settings* settings) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  pocketray_settings result;
  write_settings(instance->renderer.settings, &result);
  return to_result(write_struct("the settings", result, settings), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_set_settings(pocketray_instance* instance, const pocketray_settings* settings) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  Settings changed = instance->renderer.settings;
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, read_settings(settings, &changed));
  return to_result(plan_again(instance, changed), POCKETRAY_ERROR_LIMIT);
}

pocketray_result pocketray_get_camera(const pocketray_instance* instance, pocketray_camera* camera) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  const Camera& c = instance->renderer.view.camera;
  pocketray_camera result = POCKETRAY_CAMERA_INIT;
  from_vec3(c.eye, result.eye);
  from_vec3(c.target, result.target);
  from_vec3(c.up, result.up);
  result.projection = static_cast<int>(c.projection);
  result.vertical_fov_degrees = static_cast<double>(c.vertical_fov) * (180 / kPi);
  result.vertical_extent = c.vertical_extent;
  return to_result(write_struct("the camera", result, camera), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_set_camera(pocketray_instance* instance, const pocketray_camera* camera) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  Camera changed;
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, read_camera(camera, instance->renderer.settings, &changed));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, set_camera(&instance->renderer, changed));
  instance->refining = false;
  return POCKETRAY_OK;
}

pocketray_result pocketray_use_scene_camera(pocketray_instance* instance, std::uint32_t camera_index) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  Renderer* renderer = &instance->renderer;
  Array<const Camera> cameras = renderer->scene.cameras;
  if (camera_index > 0 && camera_index >= cameras.count)
    return refuse(POCKETRAY_ERROR_ARGUMENT,
                  failure("there is no camera %u: the scene has %u, counted from 0", camera_index, cameras.count));
  if (cameras.empty())
    frame_by_default(renderer);
  else
    renderer->view.camera = cameras[camera_index];
  renderer->view.camera_index = camera_index;
  renderer->view.camera_overridden = false;
  instance->refining = false;
  return POCKETRAY_OK;
}

pocketray_result pocketray_get_lights(const pocketray_instance* instance, pocketray_light* lights,
                                      std::uint32_t capacity, std::uint32_t* light_count) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "light_count", light_count));
  if (capacity) REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "lights", lights));
  Array<const Light> all = instance->renderer.scene.lights;
  for (std::uint32_t i = 0; i < all.count && i < capacity; ++i) lights[i] = to_caller(all[i]);
  *light_count = all.count;
  return POCKETRAY_OK;
}

pocketray_result pocketray_set_lights(pocketray_instance* instance, const pocketray_light* lights,
                                      std::uint32_t light_count) {
  const void* given = light_count ? static_cast<const void*>(lights) : instance;
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "lights", given));
  if (light_count > instance->lights.count)
    return refuse(POCKETRAY_ERROR_LIMIT, failure("%u lights, memory is reserved for %u: open with light_count_max",
                                                 light_count, instance->lights.count));
  for (std::uint32_t i = 0; i < light_count; ++i)
    REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_choice("the kind of a light", lights[i].kind, 3));
  return change_lights(instance, lights, light_count);
}

pocketray_result pocketray_get_surroundings(const pocketray_instance* instance, float background[3], float ambient[3]) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "background", background));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "ambient", ambient));
  from_vec3(instance->renderer.scene.info.background, background);
  from_vec3(instance->renderer.scene.info.ambient, ambient);
  return POCKETRAY_OK;
}

pocketray_result pocketray_set_surroundings(pocketray_instance* instance, const float background[3],
                                            const float ambient[3]) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "background", background));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "ambient", ambient));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_radiance("background", background));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_radiance("ambient", ambient));
  Renderer* renderer = &instance->renderer;
  const SceneInfo before = renderer->scene.info;
  renderer->scene.info.background = to_vec3(background);
  renderer->scene.info.ambient = to_vec3(ambient);
  Status status = plan_again(instance, renderer->settings);
  if (!status.ok) renderer->scene.info = before;
  return to_result(status, POCKETRAY_ERROR_LIMIT);
}

pocketray_result pocketray_get_node(const pocketray_instance* instance, std::uint32_t node, pocketray_node* result) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "the node", result));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_node(instance, node));
  const Renderer& renderer = instance->renderer;
  pocketray_node read = POCKETRAY_NODE_INIT;
  bool posed = renderer.pose.nodes.count > 0;
  const Node& local = posed ? renderer.pose.local_nodes[node] : renderer.scene.nodes[node];
  CHECK(!posed || renderer.pose.nodes.count == renderer.scene.nodes.count);
  Transform to_parent = compose(local.translation, local.rotation, local.scale), to_world;
  read.parent = local.parent;
  read.overridden = instance->overrides.count && instance->overrides[node].on;
  if (read.overridden) to_parent = instance->overrides[node].to_parent;
  if (posed) to_world = renderer.pose.nodes[node];
  std::memcpy(read.to_parent, to_parent.m, sizeof read.to_parent);
  std::memcpy(read.to_world, to_world.m, sizeof read.to_world);
  return to_result(write_struct("the node", read, result), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_set_node(pocketray_instance* instance, std::uint32_t node, const float to_parent[12]) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_node(instance, node));
  if (instance->renderer.pose.overrides.empty())
    return refuse(POCKETRAY_ERROR_LIMIT, failure("no memory is reserved for moving nodes: open with movable, or with "
                                                 "parts, and with the effect animation"));
  for (int i = 0; to_parent && i < 12; ++i)
    REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_limit(Quantity::coordinate, static_cast<double>(to_parent[i]),
                                                          "a number of the node's transform"));
  CHECK_EQ(instance->overrides.count, instance->renderer.scene.nodes.count);
  NodeOverride* o = &instance->overrides[node];
  o->on = to_parent != nullptr;
  if (o->on) o->to_parent = to_transform(to_parent);
  instance->refining = false;
  return POCKETRAY_OK;
}

pocketray_result pocketray_get_exposure(const pocketray_instance* instance, float* exposure) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_changing(instance, "exposure", exposure));
  *exposure = instance->renderer.view.exposure;
  return POCKETRAY_OK;
}

pocketray_result pocketray_set_exposure(pocketray_instance* instance, float exposure) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_limit(Quantity::exposure, static_cast<double>(exposure)));
  instance->renderer.view.exposure = exposure;
  instance->refining = false;
  return POCKETRAY_OK;
}

pocketray_result pocketray_set_tone(pocketray_instance* instance, int tone) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  if (tone < 0 || tone >= kToneCount)
    return refuse(POCKETRAY_ERROR_ARGUMENT, failure("the tone is %d: it must be 0 (clip) or 1 (film)", tone));
  instance->renderer.settings.tone = static_cast<Tone>(tone);
  instance->refining = false;
  return POCKETRAY_OK;
}

pocketray_result pocketray_measure_exposure(pocketray_instance* instance, double seconds, float* exposure) {
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_instance(instance));
  REFUSE_IF_ERROR(POCKETRAY_ERROR_ARGUMENT, check_limit(Quantity::seconds, seconds));
  Renderer* renderer = &instance->renderer;
  instance->refining = false;
  REFUSE_IF_ERROR(POCKETRAY_ERROR_SCENE, begin_frame(renderer, {seconds}));
  renderer->view.exposure = measure_exposure(renderer);
  if (exposure) *exposure = renderer->view.exposure;
  return POCKETRAY_OK;
}
