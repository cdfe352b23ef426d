// Rays traverse the BVH in integers, for CPUs without floating point; floats decide only where integers leave doubt,
// and locate the hits that count. So the answers are those of the other kernels, bit for bit. Like every kernel,
// compiled once per instruction set, in a namespace of its own.
//
// Rays go one by one: without vectors, packets save less than the tests of their windows cost. But a packet keeps the
// nodes and leaves that its rays met in fixed point.
#pragma once
#include "accel/bvh_single.h"
#include "accel/fixed_leaf.h"
#include "accel/fixed_node.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Converted nodes and leaves by the low bits of their numbers.
template <int kCount>
struct FixedCache {
  static_assert((kCount & (kCount - 1)) == 0, "a power of two");
  std::uint32_t node_tag[kCount], leaf_tag[kCount];
  FixedNode node[kCount];
  FixedLeaf leaf[kCount];
};
constexpr std::uint32_t kNothingCached = 0xFFFFFFFFu;

// Follows rays through a hierarchy, one after the other.
template <class Tree, int kCached>
class FixedWalk {
 public:
  FixedWalk(const Accel& accel, const HitFilter* filter, TraceStats* stats)
      : accel_(accel), tree_(accel), filter_(filter && filter->accept ? filter : nullptr), stats_(stats) {
    int low = greatest_exponent(accel.bounds.low), high = greatest_exponent(accel.bounds.high);
    bounds_exponent_ = low > high ? low : high;
    frame_.exponent = 0;
  }

  // Hit in (0, ray.t_max); hit->triangle is kNoTriangle without one.
  void find_closest(const Ray& ray, Hit* hit);
  bool find_any(const Ray& ray);

 private:
  enum class Start { nothing, in_floats, in_integers };
  Start start(const Ray& ray);
  const FixedNode& node(std::uint32_t index, const BvhNode& from);
  const FixedLeaf& leaf(std::uint32_t child, const TriangleBlock& from);
  bool locate(const TriangleBlock& block, int lane, FixedVerdict verdict, Crossing* crossing);
  bool blocks(const TriangleBlock& block, int lane, FixedVerdict verdict, bool sure, float t_max);

  const Accel& accel_;
  const Tree tree_;
  const HitFilter* filter_;
  TraceStats* stats_;
  int bounds_exponent_;
  FixedFrame frame_;
  FixedRay ray_;
  ExactRay exact_;
  TriangleBlock scratch_;
  FixedCache<kCached> cache_;
};

template <class Tree, int kCached>
auto FixedWalk<Tree, kCached>::start(const Ray& ray) -> Start {
  if (!(ray.t_max > 0) || !has_valid_origin(ray.origin) || is_empty(accel_.bounds)) return Start::nothing;
  if (!prepare_exact_ray(ray, &exact_)) return Start::nothing;
  int exponent = greatest_exponent(ray.origin);
  if (bounds_exponent_ > exponent) exponent = bounds_exponent_;
  if (exponent < kFixedExponentMin) return Start::in_floats;
  std::int32_t flip = static_cast<std::int32_t>(float_bits(exact_.direction[2])) >> 31;
  if (frame_.exponent != exponent || frame_.axes != exact_.axes || frame_.flip != flip) {
    frame_ = {exponent, exact_.axes, flip};
    for (std::uint32_t& tag : cache_.node_tag) tag = kNothingCached;
    for (std::uint32_t& tag : cache_.leaf_tag) tag = kNothingCached;
  }
  ray_ = fixed_ray(exact_, frame_);
  return Start::in_integers;
}

template <class Tree, int kCached>
const FixedNode& FixedWalk<Tree, kCached>::node(std::uint32_t index, const BvhNode& from) {
  std::uint32_t slot = index & (kCached - 1);
  if (cache_.node_tag[slot] != index) {
    cache_.node_tag[slot] = index;
    convert_node(from, frame_, &cache_.node[slot]);
  }
  return cache_.node[slot];
}

template <class Tree, int kCached>
const FixedLeaf& FixedWalk<Tree, kCached>::leaf(std::uint32_t child, const TriangleBlock& from) {
  std::uint32_t slot = child & (kCached - 1);
  if (cache_.leaf_tag[slot] != child) {
    cache_.leaf_tag[slot] = child;
    convert_leaf(from, static_cast<int>(leaf_triangle_count(child)), frame_, &cache_.leaf[slot]);
  }
  return cache_.leaf[slot];
}

template <class Tree, int kCached>
bool FixedWalk<Tree, kCached>::locate(const TriangleBlock& block, int lane, FixedVerdict verdict, Crossing* crossing) {
  return (verdict == FixedVerdict::crossed && place_in_leaf(exact_, block, lane, crossing)) ||
         cross_alone(exact_, block, lane, crossing);
}

template <class Tree, int kCached>
void FixedWalk<Tree, kCached>::find_closest(const Ray& ray, Hit* hit) {
  hit->triangle = kNoTriangle;
  Start begin = start(ray);
  if (begin == Start::in_floats) return closest<Tree>(accel_, ray, filter_, hit, stats_);
  if (begin == Start::nothing) return;
  Counts counts;
  struct Visit {
    std::uint32_t child;
    std::int32_t near;
  } stack[kBvhStackSize];
  Crossing best = {};
  float best_t = ray.t_max;
  std::uint32_t best_triangle = kNoTriangle;
  std::int32_t limit = depth_limit(ray.t_max, exact_.direction[2], frame_.exponent);
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    Visit entry = stack[--top];
    if (entry.near > limit) continue;
    if (!(entry.child & kLeafBit)) {
      const BvhNode& from = tree_.nodes[entry.child];
      const FixedNode& boxes = node(entry.child, from);
      ++counts.nodes;
      int first = top;
      for (int i = 0; i < boxes.count; ++i) {
        std::int32_t near;
        if (misses(ray_, boxes.box[i], limit, &near)) continue;
        int place = top++;
        for (; place > first && stack[place - 1].near < near; --place) stack[place] = stack[place - 1];
        stack[place] = {from.child[i], near};
      }
      continue;
    }
    const TriangleBlock& block = tree_.leaf(entry.child, &scratch_);
    const FixedLeaf& triangles = leaf(entry.child, block);
    int count = static_cast<int>(leaf_triangle_count(entry.child));
    counts.triangles += static_cast<std::uint32_t>(count);
    for (int lane = 0; lane < count; ++lane) {
      const std::int32_t* v = triangles.vertex[lane];
      FixedRow z = depth_row(ray_, v);
      if (z.low > limit || z.high < -4) continue;
      bool positive;
      FixedVerdict verdict = cross_fixed(ray_, v, z, &positive);
      if (verdict == FixedVerdict::missed) continue;
      if (verdict == FixedVerdict::crossed && z.low < 4 && surely_behind(ray_, v, z, positive)) continue;
      Crossing crossing;
      if (!locate(block, lane, verdict, &crossing)) continue;
      float t = crossing.t;
      std::uint32_t triangle = block.triangle[lane];
      if (!(t > 0 && (t < best_t || (t == best_t && triangle < best_triangle && t < ray.t_max)))) continue;
      if (filter_) {
        float u = static_cast<float>(crossing.b / crossing.sum), w = static_cast<float>(crossing.c / crossing.sum);
        if (!filter_->accept(filter_->context, triangle, u, w)) continue;
      }
      best = crossing, best_t = t, best_triangle = triangle;
      limit = depth_limit(t, exact_.direction[2], frame_.exponent);
    }
  }
  add_counts(counts, stats_);
  if (best_triangle == kNoTriangle) return;
  *hit = {best_t, static_cast<float>(best.b / best.sum), static_cast<float>(best.c / best.sum), best_triangle};
}

// Whether a triangle that the ray may cross blocks it. sure: t is certainly in (0, t_max).
template <class Tree, int kCached>
bool FixedWalk<Tree, kCached>::blocks(const TriangleBlock& block, int lane, FixedVerdict verdict, bool sure,
                                      float t_max) {
  std::uint32_t triangle = block.triangle[lane];
  const bool early = filter_ && !filter_->reads_point && !(triangle & kUnhittableBit);
  if (early && !filter_->accept(filter_->context, triangle, 0, 0)) return false;
  if (sure && (!filter_ || early)) return true;
  Crossing crossing;
  if (!locate(block, lane, verdict, &crossing) || !(crossing.t > 0 && crossing.t < t_max)) return false;
  return !filter_ || early ||
         filter_->accept(filter_->context, triangle, static_cast<float>(crossing.b / crossing.sum),
                         static_cast<float>(crossing.c / crossing.sum));
}

template <class Tree, int kCached>
bool FixedWalk<Tree, kCached>::find_any(const Ray& ray) {
  Start begin = start(ray);
  if (begin == Start::in_floats) return occluded<Tree>(accel_, ray, filter_, stats_);
  if (begin == Start::nothing) return false;
  Counts counts;
  std::uint32_t stack[kBvhStackSize];
  const FixedDepths sure = fixed_sure_depths(ray.t_max, exact_.direction[2], frame_.exponent);
  const std::int32_t limit = depth_limit(ray.t_max, exact_.direction[2], frame_.exponent);
  int top = 0;
  bool found = false;
  stack[top++] = 0;
  while (top > 0 && !found) {
    std::uint32_t child = stack[--top];
    if (!(child & kLeafBit)) {
      const BvhNode& from = tree_.nodes[child];
      const FixedNode& boxes = node(child, from);
      ++counts.nodes;
      std::int32_t near;
      for (int i = 0; i < boxes.count; ++i)
        if (!misses(ray_, boxes.box[i], limit, &near)) stack[top++] = from.child[i];
      continue;
    }
    const TriangleBlock& block = tree_.leaf(child, &scratch_);
    const FixedLeaf& triangles = leaf(child, block);
    int count = static_cast<int>(leaf_triangle_count(child));
    counts.triangles += static_cast<std::uint32_t>(count);
    for (int lane = 0; lane < count && !found; ++lane) {
      const std::int32_t* v = triangles.vertex[lane];
      FixedRow z = depth_row(ray_, v);
      if (z.low > limit || z.high < -4) continue;
      bool positive;
      FixedVerdict verdict = cross_fixed(ray_, v, z, &positive);
      if (verdict == FixedVerdict::missed) continue;
      bool crossed = verdict == FixedVerdict::crossed;
      if (crossed && z.low < 4 && surely_behind(ray_, v, z, positive)) continue;
      found = blocks(block, lane, verdict, crossed && sure.low <= z.low && z.high <= sure.high, ray.t_max);
    }
  }
  add_counts(counts, stats_);
  return found;
}

constexpr int kFixedCached = 64;

template <class Tree>
void closest_fixed(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  FixedWalk<Tree, 1>(accel, filter, stats).find_closest(ray, hit);
}

template <class Tree>
void closest_packet_fixed(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                          TraceStats* stats) {
  FixedWalk<Tree, kFixedCached> walk(accel, filter, stats);
  for (std::uint32_t i = 0; i < rays.count; ++i) walk.find_closest(ray_of(rays, i), &hits[i]);
}

template <class Tree>
bool occluded_fixed(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  return FixedWalk<Tree, 1>(accel, filter, stats).find_any(ray);
}

template <class Tree>
std::uint64_t occluded_packet_fixed(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                    TraceStats* stats) {
  FixedWalk<Tree, kFixedCached> walk(accel, filter, stats);
  std::uint64_t blocked = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i)
    blocked |= static_cast<std::uint64_t>(walk.find_any(ray_of(rays, i))) << i;
  return blocked;
}

template <class Tree>
constexpr AccelTraversal fixed_kernels_of() {
  return {closest_fixed<Tree>, closest_packet_fixed<Tree>, occluded_fixed<Tree>, occluded_packet_fixed<Tree>};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
