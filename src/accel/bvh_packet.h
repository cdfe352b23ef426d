// Rays from one point traverse the BVH together, as the pyramid over the window that contains them. Like every kernel,
// compiled once per instruction set, in a namespace of its own.
#pragma once
#include <utility>

#include "accel/bvh_tree.h"
#include "accel/leaf_batch.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Mask of the children that the pyramid meets; `depth` receives the depths at which they begin. Depth bounds are tested
// with branches, here and in leaves: branches are predicted, while a mask would wait for the last hit.
inline unsigned enter_boxes(const Packet& p, const BvhNode& node, float* depth) {
  const float *low_x = node.bounds[p.kx], *low_y = node.bounds[p.ky], *low_z = node.bounds[p.kz];
  const float *high_x = node.bounds[3 + p.kx], *high_y = node.bounds[3 + p.ky], *high_z = node.bounds[3 + p.kz];
  if (p.sign < 0) std::swap(low_z, high_z);
  Float4 zero = Float4::splat(0);
  Float4 near = max((Float4::load(low_z) - p.origin4[2]) * p.sign4, zero);
  Float4 far = (Float4::load(high_z) - p.origin4[2]) * p.sign4;
  Float4 left = min(p.window4[0] * near, p.window4[0] * far);
  Float4 right = max(p.window4[1] * near, p.window4[1] * far);
  Float4 bottom = min(p.window4[2] * near, p.window4[2] * far);
  Float4 top = max(p.window4[3] * near, p.window4[3] * far);
  Float4 x = min((Float4::load(high_x) - p.origin4[0]) - left, right - (Float4::load(low_x) - p.origin4[0]));
  Float4 y = min((Float4::load(high_y) - p.origin4[1]) - bottom, top - (Float4::load(low_y) - p.origin4[1]));
  store(depth, near);
  Mask4 inside = zero <= min(x, y) + far * Float4::splat(kPacketSlack);
  return bits(inside & (zero <= far));
}

struct DepthEntry {
  std::uint32_t child;
  float depth;
};

template <int kLanes, class Tree>
void search_packet(const Tree& bvh, Packet* p, TraceStats* stats) {
  std::uint64_t nodes = 0, triangles = 0;
  DepthEntry stack[kBvhStackSize];
  LeafBatch batch;
  int top = 0;
  stack[top++] = {0, 0};
  for (;;) {
    if (batch.count == kLeavesAtOnce || (top == 0 && batch.count > 0)) search_leaves<kLanes>(p, &batch);
    if (top == 0) break;
    DepthEntry entry = stack[--top];
    if (!(entry.depth <= p->all_far)) continue;
    if (entry.child & kLeafBit) {
      std::uint32_t count = leaf_triangle_count(entry.child);
      triangles += count;
      batch.block[batch.count] = &bvh.leaf(entry.child, &batch.scratch[batch.count]);
      batch.in_use[batch.count++] = (1u << count) - 1;
      continue;
    }
    const BvhNode& node = bvh.nodes[entry.child];
    ++nodes;
    alignas(16) float depth[4];
    int first = top;
    for (unsigned mask = enter_boxes(*p, node, depth); mask; mask &= mask - 1) {
      int lane = __builtin_ctz(mask), place = top++;
      bvh.prefetch(node.child[lane]);
      for (; place > first && stack[place - 1].depth < depth[lane]; --place) stack[place] = stack[place - 1];
      stack[place] = {node.child[lane], depth[lane]};
    }
  }
  if (stats) stats->nodes += nodes, stats->triangles += triangles;
}

inline void write_hits(const Packet& p, int count, Hit* hits) {
  if (!p.has_groups) return;
  for (int i = 0; i < count; ++i)
    if (p.triangle[i] != kNoTriangle) hits[p.place[i]] = {p.t[i], p.u[i], p.v[i], p.triangle[i]};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
