#include "bench/ours.h"

#include "base/isa.h"
#include "plan/plan_scene.h"
#include "platform/memory.h"

namespace pocketray {
namespace {

void trace_bounces(OurTask* task) {
  const OurSide& side = *task->side;
  for (std::size_t i = 0; i < task->hits.size(); ++i) {
    Hit hit;
    side.info->closest(side.accel, task->set->rays[i], nullptr, &hit, nullptr);
    task->hits[i] = hit;
  }
}

void trace_occlusion(OurTask* task) {
  const OurSide& side = *task->side;
  for (std::size_t i = 0; i < task->segments.size(); ++i)
    task->blocked[i] = side.info->occluded_packet(side.accel, task->segments[i], nullptr, nullptr);
}

static_assert(kRayTileSize == kPacketMax, "a packet is a tile");

std::vector<RayPacket> lay_out_packets(const RaySet& set) {
  std::vector<RayPacket> packets(set.rays.size() / kRayTileSize);
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    RayPacket& packet = packets[i / kRayTileSize];
    packet.origin = set.rays[i].origin, packet.t_max = set.rays[i].t_max, packet.count = kRayTileSize;
    for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i % kRayTileSize] = set.rays[i].direction[axis];
  }
  return packets;
}

// The rays from a tile's hits, if any, to the light.
void lay_out_segments(OurTask* task) {
  const RaySet& set = *task->set;
  for (std::size_t tile = 0; tile + 1 < set.tile_begin.size(); ++tile) {
    std::size_t begin = set.tile_begin[tile], end = set.tile_begin[tile + 1];
    if (begin == end) continue;
    task->segments.emplace_back();
    for (std::size_t i = begin; i < end; ++i) set_ray(&task->segments.back(), i - begin, set.rays[i]);
    task->segments.back().count = end - begin;
  }
}

}  // namespace

std::vector<bool> occlusion_of(const OurTask& task) {
  std::vector<bool> occluded;
  for (std::size_t i = 0; i < task.segments.size(); ++i)
    for (std::uint32_t k = 0; k < task.segments[i].count; ++k) occluded.push_back(task.blocked[i] >> k & 1);
  return occluded;
}

OurSide build_ours(const BenchScene& scene, const AccelInfo* info) {
  OurSide ours;
  ours.info = info;
  std::uint32_t count = scene.scene().triangles.count;
  std::size_t keep_bytes = info->need(count) + kArenaAlignment;
  std::size_t scratch_bytes = info->scratch_need(count) + kArenaAlignment;
  // In large pages if available, like the renderer's block and Embree's own.
  constexpr std::size_t kLargePage = std::size_t(2) << 20;
  ours.block.reset(new unsigned char[keep_bytes + 2 * kLargePage]);
  unsigned char* begin = ours.block.get() + (-reinterpret_cast<std::uintptr_t>(ours.block.get()) & (kLargePage - 1));
  platform::wish_large_pages(begin, (keep_bytes + kLargePage - 1) & ~(kLargePage - 1));
  std::unique_ptr<unsigned char[]> scratch_block(new unsigned char[scratch_bytes]);
  Arena keep = make_arena("keep", begin, keep_bytes);
  Arena scratch = make_arena("scratch", scratch_block.get(), scratch_bytes);
  ours.accel.positions = scene.scene().positions;
  ours.accel.triangles = scene.scene().triangles;
  ours.accel.bounds = scene.bounds;
  info->build(&ours.accel, &keep, &scratch);
  return ours;
}

void hold_ours(const std::string& isa) { select_isa(isa == "sse2" ? Isa::kBaseline : best_isa()); }

OurTask make_our_task(const OurSide& side, const RaySet& set) {
  OurTask task = {&side, &set, {}, {}, {}, {}};
  if (set.kind == RayKindOfBench::primary) task.packets = lay_out_packets(set);
  if (set.kind == RayKindOfBench::shadow) {
    lay_out_segments(&task);
    task.blocked.resize(task.segments.size());
  } else {
    task.hits.resize(set.rays.size());
  }
  return task;
}

void trace_tiles_ours(OurTask* task, std::size_t first, std::size_t count) {
  const OurSide& side = *task->side;
  for (std::size_t i = first; i < first + count; ++i)
    side.info->closest_packet(side.accel, task->packets[i], nullptr, &task->hits[i * kRayTileSize], nullptr);
}

void trace_ours(OurTask* task) {
  switch (task->set->kind) {
    case RayKindOfBench::primary:
      return trace_tiles_ours(task, 0, task->packets.size());
    case RayKindOfBench::shadow:
      return trace_occlusion(task);
    case RayKindOfBench::bounce:
      return trace_bounces(task);
  }
}

}  // namespace pocketray
