// Renderer: one scene, planned and accelerated in one block of memory, ready to render frames. Allocates nothing
// itself.
#pragma once
#include "engine/pace.h"
#include "plan/plan_memory.h"
#include "scene/animate.h"
#include "shade/trace_spans.h"

namespace pocketray {

struct Timings {
  double build_ms = 0, pose_ms = 0, refit_ms = 0, trace_ms = 0;
};

struct Renderer {
  Settings settings;
  Arena scene_arena, persistent_arena, frame_arena;
  Scene scene;
  EffectPlan effects;
  MemoryPlan memory;
  const AccelInfo* accel_info = nullptr;  // null until planned: the plan is to choose
  bool accel_is_fallback = false;         // the default did not fit
  Accel accel;
  Array<std::uint8_t> accel_data;  // writable where geometry moves
  Pose pose;
  Array<LightPoint> light_points;
  std::uint32_t light_point_count_max = 0;  // planned for
  std::uint32_t light_count_max = 0;        // lights that may be set later: their points are planned for, too
  FrameData frame;
  Array<Span> spans;            // one per scanline
  Array<std::uint64_t> row_ns;  // what each cost in the last frame
  Array<Tracer> tracers;        // one per thread
  Array<Vec3> image;            // width × height, linear
  Camera camera;
  Settings lit_settings;                 // that the frame's lights were placed for,
  EffectMask lit_mask = ~EffectMask(0);  // and effects; ~0: they were not
  bool camera_overridden = false;
  std::uint32_t camera_index = 0;
  float exposure = 1;
  Timings timings;
  Pace pace;                   // of an emulated device; as it stands: none
  Workers* workers = nullptr;  // null: the caller's thread alone
  Light default_lights[2];
};

// First step: carves the scene arena out of the block, so that the scene can be put there. The block stays the caller's
// and must outlive the renderer.
void start_renderer(void* block, std::size_t block_bytes, const Settings& settings, Renderer* renderer);

// Second step, with renderer->scene set: gives it the camera and lights it lacks, plans effects and memory. On failure
// the plans are filled as far as they were made, to be shown. `output_bytes` as plan_memory() takes it.
Status plan_renderer(Renderer* renderer, const SceneStorage& storage, std::size_t output_bytes);

// Third step: carves the arenas, builds the accelerator, poses the scene at time 0. May be called once.
Status build_renderer(Renderer* renderer);

// In place of the second and third step, for a device that shows what others render: has memory for the output alone
// and renders nothing. Camera, exposure, effects and what else of the scene the caller uses are his to set.
Status plan_without_scene(Renderer* renderer, std::size_t output_bytes);

// Changes for the coming frames what trades accuracy for time, within the memory that was planned: samples, depth,
// points per area light, cut-off, texture filter and normals may differ. Fails, and leaves everything as it was, where
// one is out of range or the lights would take more points than were planned for.
Status change_settings(Renderer* renderer, const Settings& settings);

// Sets the camera for the coming frames.
Status set_camera(Renderer* renderer, const Camera& camera);

// What all threads together did in the last frame.
Tracer total_counts(const Renderer& renderer);

// Measures exposure on a coarse grid of pixels: the scene's key value becomes middle grey [Reinhard et al. 2002,
// sec. 3.1].
float measure_exposure(Renderer* renderer);

}  // namespace pocketray
