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

void trace_primary_ours(const OurSide& ours, const Ray* rays, std::size_t count, Hit* hits) {
  for (std::size_t i = 0; i < count; ++i) {
    Hit hit;
    ours.info->closest(ours.accel, rays[i], nullptr, &hit, nullptr);
    hits[i] = hit;
  }
}

Answers room_for_answers(const RaySet& set) {
  Answers answers;
  if (set.kind == RayKindOfBench::shadow)
    answers.occluded.resize(set.rays.size());
  else
    answers.hits.resize(set.rays.size());
  return answers;
}

void trace_ours(const OurSide& ours, const RaySet& set, Answers* answers) {
  std::size_t count = set.rays.size();
  if (set.kind == RayKindOfBench::primary)
    return trace_primary_ours(ours, set.rays.data(), count, answers->hits.data());
  if (set.kind == RayKindOfBench::shadow) {
    for (std::size_t i = 0; i < count; ++i)
      answers->occluded[i] = ours.info->occluded(ours.accel, set.rays[i], nullptr, nullptr);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Hit hit;
    ours.info->closest(ours.accel, set.rays[i], nullptr, &hit, nullptr);
    answers->hits[i] = hit;
  }
}

}  // namespace pocketray
