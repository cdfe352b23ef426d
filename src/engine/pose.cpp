// Poses the scene and updates the accelerator.
#include "base/check.h"
#include "effect/effect_probe.h"
#include "engine/prepare.h"
#include "engine/recolor.h"

namespace pocketray {
namespace {

// An accelerator without refit is rebuilt, in memory that plan_memory() reserved.
void follow_motion(Renderer* renderer) {
  CHECK(renderer->accel.info != nullptr);  // it has been planned
  CHECK_EQ(renderer->frame.geometry.positions.count, renderer->scene.positions.count);
  renderer->accel.built.positions = renderer->frame.geometry.positions;
  if (renderer->accel.info->refit) return renderer->accel.info->refit(&renderer->accel.built, renderer->accel.data);
  Arena keep = make_arena("accelerator", renderer->accel.data.data, renderer->accel.data.bytes());
  renderer->accel.info->build(&renderer->accel.built, &keep, &renderer->memory.frame);
}

// If a material would then call for an effect that the opened scene does not, it keeps its last values.
void change_posed_materials(Renderer* renderer) {
  for (const Channel& channel : renderer->scene.channels) {
    if (channel.path < ChannelPath::material_diffuse) continue;
    const Material& posed = renderer->pose.materials[channel.node];
    Material material = renderer->scene.materials[channel.node];
    if (material.diffuse == posed.diffuse && material.emission == posed.emission) continue;
    material.diffuse = posed.diffuse, material.emission = posed.emission;
    (void)change_material(renderer, channel.node, material);
  }
}

void pose_at_time(Renderer* renderer, double seconds) {
  renderer->frame.geometry.positions = renderer->scene.positions;
  renderer->frame.geometry.normals =
      has(renderer->effects.mask, Effect::smooth_normal) ? renderer->scene.normals : Array<const Vec3>();
  if (!has(renderer->effects.mask, Effect::animation) || !is_animated(renderer->scene)) return;
  effect_entered<Effect::animation>();
  pose_at(opened_scene(*renderer), renderer->view.animation, seconds, &renderer->pose);
  if (renderer->pose.materials.count) change_posed_materials(renderer);
  if (renderer->pose.positions.count) renderer->frame.geometry.positions = renderer->pose.positions;
  if (renderer->frame.geometry.normals.count && renderer->pose.normals.count)
    renderer->frame.geometry.normals = renderer->pose.normals;
}

}  // namespace

void pose_scene(Renderer* renderer, double seconds) {
  std::uint64_t start = renderer->pace.clock->now_ns();
  pose_at_time(renderer, seconds);
  wait_for_pace(&renderer->pace, 0, start);
  renderer->timings.pose_ms = static_cast<double>(renderer->pace.clock->now_ns() - start) * 1e-6;
}

void accelerate(Renderer* renderer) {
  std::uint64_t start = renderer->pace.clock->now_ns();
  if (renderer->pose.positions.count) follow_motion(renderer);
  wait_for_pace(&renderer->pace, 0, start);
  renderer->timings.refit_ms = static_cast<double>(renderer->pace.clock->now_ns() - start) * 1e-6;
  renderer->frame.geometry.accel = renderer->accel.built;
}

}  // namespace pocketray
