#include "bench/ours.h"

#include "plan/plan_scene.h"

namespace pocketray {
namespace {

void trace_hits(OurTask* task, std::size_t first, std::size_t count) {
  const OurSide& side = *task->side;
  for (std::size_t i = first; i < first + count; ++i) {
    Hit hit;
    side.info->closest(side.accel, task->set->rays[i], nullptr, &hit, nullptr);
    task->hits[i] = hit;
  }
}

void trace_occlusion(OurTask* task, std::size_t first, std::size_t count) {
  const OurSide& side = *task->side;
  for (std::size_t i = first; i < first + count; ++i)
    task->occluded[i] = side.info->occluded(side.accel, task->set->rays[i], nullptr, nullptr);
}

}  // namespace

OurSide build_ours(const BenchScene& scene, const AccelInfo* info) {
  OurSide ours;
  ours.info = info;
  std::uint32_t count = scene.scene().triangles.count;
  std::size_t keep_bytes = info->need(count) + kArenaAlignment;
  std::size_t scratch_bytes = info->scratch_need(count) + kArenaAlignment;
  ours.block.reset(new unsigned char[keep_bytes]);
  std::unique_ptr<unsigned char[]> scratch_block(new unsigned char[scratch_bytes]);
  Arena keep = make_arena("keep", ours.block.get(), keep_bytes);
  Arena scratch = make_arena("scratch", scratch_block.get(), scratch_bytes);
  ours.accel.positions = scene.scene().positions;
  ours.accel.triangles = scene.scene().triangles;
  ours.accel.bounds = scene.bounds;
  info->build(&ours.accel, &keep, &scratch);
  return ours;
}

// The core has one build for every CPU so far, and it is the one for SSE2.
void hold_ours(const std::string&) {}

OurTask make_our_task(const OurSide& side, const RaySet& set) {
  OurTask task = {&side, &set, {}, {}};
  if (set.kind == RayKindOfBench::shadow)
    task.occluded.resize(set.rays.size());
  else
    task.hits.resize(set.rays.size());
  return task;
}

void trace_tiles_ours(OurTask* task, std::size_t first, std::size_t count) {
  trace_hits(task, first * kTileSize, count * kTileSize);
}

void trace_ours(OurTask* task) {
  std::size_t count = task->set->rays.size();
  switch (task->set->kind) {
    case RayKindOfBench::primary:
      return trace_tiles_ours(task, 0, count / kTileSize);
    case RayKindOfBench::shadow:
      return trace_occlusion(task, 0, count);
    case RayKindOfBench::bounce:
      return trace_hits(task, 0, count);
  }
}

}  // namespace pocketray
