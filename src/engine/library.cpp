// The library's version, errors, and checks shared by its calls.
#include "engine/library.h"

#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"
#include "scene/builtin/builtin.h"
#include "shade/camera.h"

namespace pocketray {
namespace {

thread_local char last_message[sizeof Status::message] = {0};

}  // namespace

pocketray_result refuse(pocketray_result result, const Status& status) {
  CHECK_LT(result, 0);
  CHECK(!status.ok);
  std::memcpy(last_message, status.message, sizeof last_message);
  return result;
}

Status check_struct(const char* name, const void* structure, std::size_t size) {
  if (!structure) return failure("%s is a null pointer", name);
  std::size_t given;
  std::memcpy(&given, structure, sizeof given);
  if (given == size) return success();
  return failure("%s->struct_size is %zu, this library's is %zu: initialise it with the structure's _INIT", name, given,
                 size);
}

Status check_instance(const pocketray_instance* instance) {
  if (instance) return success();
  return failure("the instance is a null pointer: open one first and check the result");
}

Status check_choice(const char* name, int value, int choice_count) {
  CHECK_GT(choice_count, 0);
  if (value >= 0 && value < choice_count) return success();
  return failure("%s is %d: it must lie in 0 … %d", name, value, choice_count - 1);
}

Status read_camera(const pocketray_camera* given, const Settings& settings, Camera* camera) {
  pocketray_camera c = POCKETRAY_CAMERA_INIT;
  RETURN_IF_ERROR(read_struct("the camera", given, &c));
  RETURN_IF_ERROR(check_choice("the camera's projection", c.projection, 2));
  Camera read;
  read.eye = to_vec3(c.eye);
  read.target = to_vec3(c.target);
  read.up = to_vec3(c.up);
  read.projection = static_cast<Projection>(c.projection);
  if (read.projection == Projection::perspective) {
    read.vertical_fov = within(Quantity::coordinate, c.vertical_fov_degrees)
                            ? static_cast<float>(radians(c.vertical_fov_degrees))
                            : __builtin_nanf("");
  } else {
    read.vertical_extent = c.vertical_extent;
  }
  CameraRays rays;
  RETURN_IF_ERROR(make_camera_rays(read, settings.width, settings.height, &rays));
  *camera = read;
  return success();
}

Status plan_again(pocketray_instance* instance, const Settings& settings) {
  Renderer* renderer = &instance->renderer;
  RETURN_IF_ERROR(change_settings(renderer, settings));
  renderer->lights.lit_mask = ~EffectMask(0);  // place lights again
  instance->refining = false;
  return success();
}

}  // namespace pocketray

using namespace pocketray;

std::uint32_t pocketray_version(void) { return POCKETRAY_VERSION_NUMBER; }

const char* pocketray_error_message(void) { return last_message; }

const char* pocketray_builtin_name(std::uint32_t index) {
  int count;
  const BuiltinScene* scenes = builtin_list(&count);
  return index < static_cast<std::uint32_t>(count) ? scenes[index].name : nullptr;
}
