// A frame in one sentence: scene → plan → accelerate → trace + shade spans. What is planned was planned before the
// first frame; showing the frame is the caller's.
#include "engine/frame.h"

#include "base/color.h"
#include "base/limit_list.h"
#include "effect/effect_probe.h"
#include "effect/setting_list.h"
#include "plan/plan_lights.h"
#include "shade/camera.h"
#include "shade/filters.h"
#include "shade/media.h"
#include "shade/shade.h"
#include "shade/surface.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

void pose_scene(Renderer* r, double seconds) {
  r->frame.positions = r->scene.positions;
  r->frame.normals = has(r->effects.mask, Effect::smooth_normal) ? r->scene.normals : Array<const Vec3>();
  if (!has(r->effects.mask, Effect::animation) || !is_animated(r->scene)) return;
  effect_entered<Effect::animation>();
  pose_at(r->scene, 0, seconds, &r->pose);
  if (r->pose.positions.count) r->frame.positions = r->pose.positions;
  if (r->frame.normals.count && r->pose.normals.count) r->frame.normals = r->pose.normals;
}

// An accelerator that cannot be refitted is built anew, in the memory that plan_memory() set aside for that.
void follow_motion(Renderer* r) {
  r->accel.positions = r->frame.positions;
  if (r->accel_info->refit) return r->accel_info->refit(&r->accel, r->accel_data);
  Arena keep = make_arena("accelerator", r->accel_data.data, r->accel_data.bytes());
  r->accel_info->build(&r->accel, &keep, &r->frame_arena);
}

void accelerate(Renderer* r) {
  std::uint64_t start = clock_ns();
  if (r->pose.positions.count) follow_motion(r);
  wait_for_pace(&r->pace, 0, start);
  r->timings.refit_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  r->frame.accel = r->accel;
}

void choose_kernels(Renderer* r) {
  r->frame.scene = &r->scene;
  r->frame.accel_info = r->accel_info;
  r->frame.settings = r->settings;
  r->frame.mask = r->effects.mask;
  r->frame.surface = find_surface_function(r->effects.mask);
  r->frame.radiance = find_radiance_function(r->effects.mask);
  r->frame.find_shadows = has(r->effects.mask, Effect::shadow) ? find_tile_shadows : nullptr;
  make_filters(&r->frame);
}

// Whether the lights of the last frame are this one's, too: nothing moves, and nothing that they follow from has
// changed.
bool is_lit(const Renderer& r) {
  return r.lit_mask == r.effects.mask && !r.pose.positions.count && !r.pose.lights.count &&
         same_lights(r.lit_settings, r.settings);
}

void light_scene(Renderer* r) {
  if (!is_lit(*r)) {
    place_lights(r->pose.lights.count ? Array<const Light>(r->pose.lights) : r->scene.lights, r->light_points,
                 &r->frame);
    bool spawns = has(r->effects.mask, Effect::mirror) || has(r->effects.mask, Effect::refraction) ||
                  has(r->effects.mask, Effect::alpha_blend);
    r->frame.radiance_bound = spawns ? radiance_bound(r->frame) : 0;
    r->lit_settings = r->settings;
    r->lit_mask = r->effects.mask;
  }
  r->frame.left_out_max = 2 * kHalfLevel * r->settings.cut_off_levels / r->exposure;
}

Status aim_camera(Renderer* r) {
  if (!r->camera_overridden && r->pose.cameras.count) r->camera = r->pose.cameras[r->camera_index];
  RETURN_IF_ERROR(make_camera_rays(r->camera, r->settings.width, r->settings.height, &r->frame.camera));
  r->frame.eye_media = MediumStack();
  if (has(r->effects.mask, Effect::refraction))
    r->frame.eye_media = media_at(r->frame, r->frame.camera.eye, r->frame.camera.forward);
  return success();
}

std::uint32_t trace(Renderer* r, Aov aov, const std::atomic<bool>* stop) {
  for (Tracer& tracer : r->tracers) tracer = make_tracer(r->frame);
  std::uint64_t start = clock_ns();
  std::uint32_t rows = trace_paced(
      &r->pace, r->workers, {r->spans.data, r->spans.count, aov, r->image.data, r->tracers.data, r->row_ns.data, stop});
  r->timings.trace_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  return rows;
}

}  // namespace

Status prepare_frame(Renderer* r, double seconds) {
  RETURN_IF_ERROR(check_limit(Quantity::seconds, seconds));
  r->pace.owed_ns = 0;
  std::uint64_t start = clock_ns();
  pose_scene(r, seconds);
  wait_for_pace(&r->pace, 0, start);
  r->timings.pose_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  accelerate(r);
  choose_kernels(r);
  light_scene(r);
  return aim_camera(r);
}

Status render_frame(Renderer* r, double seconds, Aov aov, const std::atomic<bool>* stop, std::uint32_t* rows_done) {
  RETURN_IF_ERROR(prepare_frame(r, seconds));
  std::uint32_t rows = trace(r, aov, stop);
  if (rows_done) *rows_done = rows;
  return success();
}

}  // namespace pocketray
