#include "bench/ray_sets.h"

#include <algorithm>

#include "app/options.h"

namespace pocketray {
namespace {

float lit_share(const OurSide& ours, const RaySet& shadow) {
  OurTask task = make_our_task(ours, shadow);
  trace_ours(&task);
  std::vector<bool> occluded = occlusion_of(task);
  std::size_t lit = static_cast<std::size_t>(std::count(occluded.begin(), occluded.end(), false));
  return static_cast<float>(lit) / static_cast<float>(shadow.rays.empty() ? 1 : shadow.rays.size());
}

RaySet lit_shadow_rays(const BenchScene& scene, const OurSide& ours, const RaySet& primary,
                       const std::vector<Hit>& hits) {
  RaySet shadow;
  for (float distance = 0.25f; distance > 0.01f; distance /= 2) {
    shadow = make_shadow_rays(scene, primary, hits, distance);
    if (lit_share(ours, shadow) > 1 / 3.0f) break;
  }
  return shadow;
}

}  // namespace

Status make_ray_sets(const BenchScene& scene, const std::string& size, const std::vector<std::string>& kinds,
                     const OurSide& ours, std::vector<RaySet>* sets) {
  auto asks = [&](RayKindOfBench kind) {
    return std::find(kinds.begin(), kinds.end(), kBenchRayNames[static_cast<int>(kind)]) != kinds.end();
  };
  std::uint32_t width, height;
  RETURN_IF_ERROR(parse_size(size, &width, &height));
  RaySet primary;
  RETURN_IF_ERROR(make_primary_rays(scene, width, height, &primary));
  OurTask task = make_our_task(ours, primary);
  trace_ours(&task);
  if (asks(RayKindOfBench::shadow)) sets->push_back(lit_shadow_rays(scene, ours, primary, task.hits));
  if (asks(RayKindOfBench::bounce)) sets->push_back(make_bounce_rays(scene, primary, task.hits));
  if (asks(RayKindOfBench::primary)) sets->insert(sets->begin(), std::move(primary));
  return success();
}

}  // namespace pocketray
