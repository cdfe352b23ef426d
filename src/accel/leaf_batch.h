// Tests the rays of a packet against a few leaves. Part of the kernels: see bvh_packet.h.
//
// Leaves whose projection is small are searched in steps, each over all leaves: find the rays in their bounds, run the
// float test of a triangle on these, settle the hits of those that pass. The iterations of a step do not wait for each
// other's results, as they would leaf by leaf.
#pragma once
#include "accel/bvh.h"
#include "accel/packet_leaf.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kLeavesAtOnce = 8;

struct LeafBatch {
  int count = 0;
  const TriangleBlock* block[kLeavesAtOnce];
  unsigned in_use[kLeavesAtOnce];  // lanes that hold triangles
  LeafProjection projection[kLeavesAtOnce];
  TriangleBlock scratch[kLeavesAtOnce];  // for leaves whose triangles are fetched
};

// RayTest: rays from `first` on that may hit a leaf. Candidate: a ray and a lane of a leaf that passed the float test.
struct RayTest {
  std::uint8_t leaf, first;
};
struct Candidate {
  std::uint8_t leaf, lane, ray;
  bool sure;
};

// Returns whether to test each ray in the leaf's bounds against all four triangles, which is faster for fewer than
// about ten rays (measured with bench_embree).
inline bool is_small(const Packet& p, const LeafProjection& leaf) {
  float width = leaf.bounds.x_high - leaf.bounds.x_low, height = leaf.bounds.y_high - leaf.bounds.y_low;
  width = width < 2 ? width : 2, height = height < 2 ? height : 2;  // no window is larger; avoids 0·∞
  return !leaf.behind && width * height * 1.5f <= p.half_x * p.half_y;
}

template <int kLanes>
int list_tests(const Packet& p, const LeafProjection& leaf, int index, RayTest* tests) {
  constexpr int kRays = kLanes / 4;
  const Window& w = leaf.bounds;
  Bounds4 bounds = {Float4::splat(w.x_low - kPacketSlack), Float4::splat(w.x_high + kPacketSlack),
                    Float4::splat(w.y_low - kPacketSlack), Float4::splat(w.y_high + kPacketSlack)};
  int count = 0;
  for (unsigned blocks = bits(meets(bounds, p.block)); blocks; blocks &= blocks - 1) {
    int b = __builtin_ctz(blocks);
    for (unsigned groups = bits(meets(bounds, p.group[b])); groups; groups &= groups - 1) {
      int group = 4 * b + __builtin_ctz(groups), first = 4 * group;
      if (!(leaf.nearest <= p.group_far[group])) continue;
      Float4 x = Float4::load(p.x + first), y = Float4::load(p.y + first);
      unsigned rays = bits((bounds.x_low <= x) & (x <= bounds.x_high) & (bounds.y_low <= y) & (y <= bounds.y_high));
      while (rays) {
        int i = __builtin_ctz(rays) & ~(kRays - 1);
        tests[count++] = {static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(first + i)};
        rays &= ~(((1u << kRays) - 1) << i);
      }
    }
  }
  return count;
}

// The float test of cross_triangle(): kLanes/4 rays from `first` on against the leaf's four triangles.
template <int kLanes>
Passing test_rays(const Packet& p, const LeafProjection& leaf, int first) {
  using F = typename Lanes<kLanes>::Floats;
  F qx = F::spread(p.x + first), qy = F::spread(p.y + first), x[3], y[3];
  for (int k = 0; k < 3; ++k) {
    F depth = F::repeat(Float4::load(leaf.depth[k]));
    x[k] = F::repeat(Float4::load(leaf.x[k])) - qx * depth, y[k] = F::repeat(Float4::load(leaf.y[k])) - qy * depth;
  }
  EdgeValues<F> e = edge_values<F>(x[0], y[0], x[1], y[1], x[2], y[2]);
  F zero = F::splat(0), low = min(min(e.a, e.b), e.c), high = max(max(e.a, e.b), e.c);
  return {bits((zero <= low) | (high <= zero)), bits((zero < low) | (high < zero))};
}

inline void settle_candidates(Packet* p, const LeafBatch& batch, const Candidate* candidates, int count) {
  for (int n = 0; n < count; ++n) {
    const Candidate& c = candidates[n];
    const TriangleBlock& block = *batch.block[c.leaf];
    if (!(batch.projection[c.leaf].near[c.lane] <= p->far[c.ray])) continue;
    if (!(c.sure ? settle_ray(p, block, c.lane, c.ray) : settle_doubtful(p, block, c.lane, c.ray))) continue;
    p->group_far[c.ray / 4] = highest(Float4::load(p->far + (c.ray & ~3)));
  }
}

template <int kLanes>
void search_small_leaves(Packet* p, const LeafBatch& batch, const RayTest* tests, int test_count) {
  constexpr unsigned kEachRay = 0x1111;
  Candidate candidates[kBvhLeafSize * kLeavesAtOnce * kPacketMax];
  int candidate_count = 0;
  for (int n = 0; n < test_count; ++n) {
    const RayTest& test = tests[n];
    const LeafProjection& leaf = batch.projection[test.leaf];
    Passing found = test_rays<kLanes>(*p, leaf, test.first);
    for (unsigned pass = found.pass & (leaf.lanes & batch.in_use[test.leaf]) * kEachRay; pass; pass &= pass - 1) {
      int bit = __builtin_ctz(pass);
      candidates[candidate_count++] = {test.leaf, static_cast<std::uint8_t>(bit % 4),
                                       static_cast<std::uint8_t>(test.first + bit / 4), (found.sure >> bit & 1) != 0};
    }
  }
  settle_candidates(p, batch, candidates, candidate_count);
}

// Searches the leaves of the batch and empties it.
template <int kLanes>
void search_leaves(Packet* p, LeafBatch* batch) {
  if (!p->has_groups) prepare_groups(p);
  for (int i = 0; i < batch->count; ++i) project_leaf(*p, *batch->block[i], &batch->projection[i]);
  RayTest tests[kLeavesAtOnce * kPacketMax];
  int test_count = 0;
  for (int i = 0; i < batch->count; ++i) {
    LeafProjection& leaf = batch->projection[i];
    unsigned lanes = leaf.lanes & batch->in_use[i];
    if (!lanes || !(leaf.nearest <= p->all_far)) continue;
    if (is_small(*p, leaf)) {
      test_count += list_tests<kLanes>(*p, leaf, i, tests + test_count);
    } else {
      for (; lanes; lanes &= lanes - 1) search_triangle<kLanes>(p, *batch->block[i], &leaf, __builtin_ctz(lanes));
    }
  }
  if (test_count > 0) search_small_leaves<kLanes>(p, *batch, tests, test_count);
  update_all_far(p);
  batch->count = 0;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
