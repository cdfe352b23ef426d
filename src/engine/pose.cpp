// Poses the scene and brings the accelerator after it.
#include "effect/effect_probe.h"
#include "engine/prepare.h"

namespace pocketray {
namespace {

// An accelerator that cannot be refitted is built anew, in the memory that plan_memory() set aside for that.
void follow_motion(Renderer* r) {
  r->accel.positions = r->frame.positions;
  if (r->accel_info->refit) return r->accel_info->refit(&r->accel, r->accel_data);
  Arena keep = make_arena("accelerator", r->accel_data.data, r->accel_data.bytes());
  r->accel_info->build(&r->accel, &keep, &r->frame_arena);
}

void pose_at_time(Renderer* r, double seconds) {
  r->frame.positions = r->scene.positions;
  r->frame.normals = has(r->effects.mask, Effect::smooth_normal) ? r->scene.normals : Array<const Vec3>();
  if (!has(r->effects.mask, Effect::animation) || !is_animated(r->scene)) return;
  effect_entered<Effect::animation>();
  pose_at(r->scene, 0, seconds, &r->pose);
  if (r->pose.positions.count) r->frame.positions = r->pose.positions;
  if (r->frame.normals.count && r->pose.normals.count) r->frame.normals = r->pose.normals;
}

}  // namespace

void pose_scene(Renderer* r, double seconds) {
  std::uint64_t start = clock_ns();
  pose_at_time(r, seconds);
  wait_for_pace(&r->pace, 0, start);
  r->timings.pose_ms = static_cast<double>(clock_ns() - start) * 1e-6;
}

void accelerate(Renderer* r) {
  std::uint64_t start = clock_ns();
  if (r->pose.positions.count) follow_motion(r);
  wait_for_pace(&r->pace, 0, start);
  r->timings.refit_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  r->frame.accel = r->accel;
}

}  // namespace pocketray
