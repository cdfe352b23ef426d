#include "bench/ours.h"

#include "plan/plan_scene.h"

namespace pocketray {

OurSide build_ours(const BenchScene& scene, const AccelInfo* info) {
  OurSide ours;
  ours.info = info;
  std::uint32_t count = scene.scene().triangles.count;
  std::size_t keep_bytes = info->need(count) + kArenaAlignment;
  std::size_t scratch_bytes = info->scratch_need(count) + kArenaAlignment;
  ours.keep_block.reset(new unsigned char[keep_bytes]);
  ours.scratch_block.reset(new unsigned char[scratch_bytes]);
  Arena keep = make_arena("keep", ours.keep_block.get(), keep_bytes);
  Arena scratch = make_arena("scratch", ours.scratch_block.get(), scratch_bytes);
  ours.accel.positions = scene.scene().positions;
  ours.accel.triangles = scene.scene().triangles;
  ours.accel.bounds = scene.bounds;
  info->build(&ours.accel, &keep, &scratch);
  return ours;
}

// The core has one build for every CPU so far, and it is the one for SSE2.
void hold_ours(const std::string&) {}

void trace_primary_ours(const OurSide& ours, const RaySet& set, std::vector<Hit>* hits) {
  trace_bounce_ours(ours, set, hits);
}

void trace_bounce_ours(const OurSide& ours, const RaySet& set, std::vector<Hit>* hits) {
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    Hit hit;
    ours.info->closest(ours.accel, set.rays[i], nullptr, &hit, nullptr);
    (*hits)[i] = hit;
  }
}

void trace_shadow_ours(const OurSide& ours, const RaySet& set, std::vector<unsigned char>* occluded) {
  for (std::size_t i = 0; i < set.rays.size(); ++i)
    (*occluded)[i] = ours.info->occluded(ours.accel, set.rays[i], nullptr, nullptr);
}

}  // namespace pocketray
