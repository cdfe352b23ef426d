#include "session/measured_view.h"

#include <algorithm>
#include <vector>

#include "base/check.h"
#include "plan/plan_scene.h"
#include "scene/animate.h"

namespace pocketray {
namespace {

// Chosen: 64 poses of an animation turn by 6° each in a full turn; models of a million triangles get fewer, so that
// measuring takes less than a second.
constexpr std::uint32_t kPosesMin = 8, kPosesMax = 64;
constexpr std::uint64_t kTriangleVisitsMax = std::uint64_t(1) << 22;

std::uint32_t pose_count(const Scene& scene) {
  const std::uint64_t visits = std::uint64_t(scene.triangles.count) * scene.animations.count;
  const std::uint64_t count = kTriangleVisitsMax / std::max<std::uint64_t>(visits, 1);
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(count, kPosesMin, kPosesMax));
}

// Puts framings of all poses of each animation before the one at time 0.
void extend_to_poses(const Scene& scene, const Box& bounds, std::vector<Framing>* framings) {
  std::vector<std::uint8_t> memory(pose_need(scene) + kArenaAlignment);
  Arena arena = make_arena("pose", memory.data(), memory.size());
  Pose pose = make_pose(scene, &arena);
  if (pose.positions.empty()) return;
  const Framing at_rest = framings->at(0);
  const std::uint32_t count = pose_count(scene);
  framings->clear();
  for (std::uint32_t animation = 0; animation < scene.animations.count; ++animation) {
    ReachMeter meter(center(bounds), at_rest.backward);
    for (std::uint32_t i = 0; i < count; ++i) {
      pose_at(scene, animation, static_cast<double>(scene.animations[animation].duration) * i / count, &pose);
      add_reach(scene, {pose.positions.data, pose.positions.count}, &meter);
    }
    framings->push_back(meter.framing());
  }
  framings->push_back(at_rest);
}

}  // namespace

bool needs_view(const Scene& scene) {
  return scene.cameras.empty() || !has_light(scene) || scene.info.default_lights != 0;
}

void measure_view(Scene* scene, MeasuredView* measured) {
  CHECK(scene != nullptr && measured != nullptr);
  scene->default_view = {}, scene->framings = {};
  const Box bounds = scene_bounds(*scene);
  measured->view = find_default_view(*scene, bounds);
  measured->framings = {measure_framing(*scene, measured->view, bounds)};
  if (is_animated(*scene) && !is_zero(measured->framings[0].backward))
    extend_to_poses(*scene, bounds, &measured->framings);
  scene->default_view = {&measured->view, 1};
  scene->framings = {measured->framings.data(), static_cast<std::uint32_t>(measured->framings.size())};
}

}  // namespace pocketray
