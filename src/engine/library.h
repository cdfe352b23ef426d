// Shared by the library's files. Its callers only see pocketray.h.
#pragma once
#include <atomic>
#include <cstddef>

#include "engine/pocketray.h"
#include "engine/progressive.h"
#include "engine/renderer.h"

struct pocketray_instance {
  pocketray::Renderer renderer;
  pocketray::Array<pocketray::Light> lights;            // set by the caller; empty: the scene's lights
  pocketray::Array<pocketray::Light> posed_lights;      // room for as many, if anything moves
  pocketray::Array<pocketray::NodeOverride> overrides;  // one per node; empty: only the animation moves nodes
  pocketray::Array<pocketray::Span> tile_spans;         // for pocketray_refine()
  pocketray::Progressive progressive;
  bool refining = false;  // a frame was begun and nothing has changed since
  std::uint32_t rows_done = 0;
  std::atomic<bool> stop{false};
  pocketray_progress progress = nullptr;
  void* progress_user = nullptr;
};

namespace pocketray {

// Stores the message for pocketray_error_message() and returns the result.
pocketray_result refuse(pocketray_result result, const Status& status);
// POCKETRAY_OK, or `result` with the status's message stored.
inline pocketray_result to_result(const Status& status, pocketray_result result) {
  return status.ok ? POCKETRAY_OK : refuse(result, status);
}

// Checks that a caller's structure is readable: not null, and of this library's size. A field added at the end of one,
// in a version with the same minor number, must accept the size before it, too.
Status check_struct(const char* name, const void* structure, std::size_t size);

// Copies a caller's structure.
template <class T>
Status read_struct(const char* name, const T* given, T* result) {
  RETURN_IF_ERROR(check_struct(name, given, sizeof(T)));
  *result = *given;
  return success();
}
// Copies a structure into a caller's.
template <class T>
Status write_struct(const char* name, T value, T* given) {
  RETURN_IF_ERROR(check_struct(name, given, sizeof(T)));
  value.struct_size = sizeof(T);
  *given = value;
  return success();
}

Status check_instance(const pocketray_instance* instance);
Status check_choice(const char* name, int value, int choice_count);  // 0 … choice_count − 1

inline Vec3 to_vec3(const float* v) { return {v[0], v[1], v[2]}; }
inline void from_vec3(const Vec3& v, float* result) { result[0] = v.x, result[1] = v.y, result[2] = v.z; }

// Reads the settings in a caller's list into *settings and checks them.
Status read_settings(const pocketray_settings* given, Settings* settings);
void write_settings(const Settings& settings, pocketray_settings* result);
// Fails whenever make_camera_rays() would.
Status read_camera(const pocketray_camera* given, const Settings& settings, Camera* camera);

// Bytes that pocketray_open() needs for the planned renderer.
std::size_t instance_need(const Renderer& renderer);
void write_plan(const Renderer& renderer, std::size_t scratch_bytes, pocketray_plan* plan);

// Replans effects after a change of the scene or settings, within the planned memory. Ends a frame in progress.
Status plan_again(pocketray_instance* instance, const Settings& settings);

}  // namespace pocketray
