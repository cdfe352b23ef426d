// Single rays traverse the BVH in integers; bundles share the leaf code. Part of the kernels: see
// bvh_fixed.h.
#pragma once
#include "accel/bvh_single.h"
#include "accel/fixed_box.h"
#include "accel/fixed_leaf.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// A ray in both forms.
struct DualRay {
  ExactRay exact;
  FixedRay fixed;
  float t_max;
};

// Data of a query. accept() of the filter is not null.
template <class Tree>
struct FixedQuery {
  FixedQuery(const Accel& a, const HitFilter* f, TraceStats* s)
      : accel(a), tree(a), filter(f && f->accept ? f : nullptr), stats(s) {
    int low = greatest_exponent(a.bounds.low), high = greatest_exponent(a.bounds.high);
    bounds_exponent = low > high ? low : high;
  }
  const Accel& accel;
  const Tree tree;
  const HitFilter* filter;
  TraceStats* stats;
  int bounds_exponent;
};

// How a ray starts: it hits nothing, its coordinates are too small for integers, or neither.
enum class FixedStart { nothing, in_floats, in_integers };
template <class Tree>
FixedStart start_fixed(const FixedQuery<Tree>& query, const Ray& ray, int* of_class, int* exponent) {
  if (!(ray.t_max > 0) || !has_valid_origin(ray.origin) || is_empty(query.accel.bounds)) return FixedStart::nothing;
  *of_class = fixed_class(ray.direction), *exponent = greatest_exponent(ray.origin);
  if (*of_class < 0) return FixedStart::nothing;
  if (query.bounds_exponent > *exponent) *exponent = query.bounds_exponent;
  return *exponent < kFixedExponentMin ? FixedStart::in_floats : FixedStart::in_integers;
}
inline void make_dual_ray(const Ray& ray, const FixedFrame& frame, DualRay* dual) {
  make_exact_ray(ray, frame.axes, &dual->exact);
  dual->fixed = fixed_ray(dual->exact, frame);
  dual->t_max = ray.t_max;
}

// The best hit of a ray so far, and the depth beyond which none is better.
struct FixedBest {
  Crossing crossing;
  float t;
  std::uint32_t triangle;
  std::int32_t limit;
};
inline void begin_best(const DualRay& ray, const FixedFrame& frame, FixedBest* best) {
  best->t = ray.t_max, best->triangle = kNoTriangle;
  best->limit = depth_limit(ray.t_max, ray.exact.direction[2], frame.exponent);
}
inline void write_hit(const FixedBest& best, Hit* hit) {
  if (best.triangle == kNoTriangle) return;
  const Crossing& c = best.crossing;
  *hit = {best.t, static_cast<float>(c.b / c.sum), static_cast<float>(c.c / c.sum), best.triangle};
}

// The edge functions of a crossed triangle exceed 12 A units with A as in fixed_leaf.h; place_in_leaf() computes them
// with an error below 2^-48 S A for a triangle within S of the origin, S < 2^29: with the same signs.
inline bool locate(const DualRay& ray, const TriangleBlock& block, int lane, FixedVerdict verdict, Crossing* crossing) {
  return (verdict == FixedVerdict::crossed && place_in_leaf<true>(ray.exact, block, lane, crossing)) ||
         cross_alone(ray.exact, block, lane, crossing);
}
inline bool accepts(const HitFilter& filter, std::uint32_t triangle, const Crossing& crossing) {
  return filter.accept(filter.context, triangle, static_cast<float>(crossing.b / crossing.sum),
                       static_cast<float>(crossing.c / crossing.sum));
}

// Takes the hit of a triangle `v` of a leaf if it beats the best so far. Returns whether it did.
inline bool improves(const DualRay& ray, const FixedFrame& frame, const HitFilter* filter, const TriangleBlock& block,
                     int lane, const FixedTriangle& v, FixedBest* best) {
  FixedRow z = depth_row(ray.fixed, v);
  if (z.low > best->limit || z.high < -4) return false;
  bool positive;
  FixedVerdict verdict = cross_fixed(ray.fixed, v, z, &positive);
  if (verdict == FixedVerdict::missed) return false;
  FixedPlane plane;
  if (verdict == FixedVerdict::crossed && (z.low < 4 || z.high > best->limit) &&
      fixed_plane(ray.fixed, v, z, positive, &plane) && surely_outside(plane, ray.fixed, z, best->limit))
    return false;
  Crossing crossing;
  if (!locate(ray, block, lane, verdict, &crossing)) return false;
  float t = crossing.t;
  std::uint32_t triangle = block.triangle[lane];
  if (!(t > 0 && (t < best->t || (t == best->t && triangle < best->triangle && t < ray.t_max)))) return false;
  if (filter && !accepts(*filter, triangle, crossing)) return false;
  *best = {crossing, t, triangle, depth_limit(t, ray.exact.direction[2], frame.exponent)};
  return true;
}

// Depths of a ray's t_max.
struct FixedEnd {
  FixedDepths sure;
  std::int32_t limit;
};
inline FixedEnd end_of(const DualRay& ray, const FixedFrame& frame) {
  return {fixed_sure_depths(ray.t_max, ray.exact.direction[2], frame.exponent),
          depth_limit(ray.t_max, ray.exact.direction[2], frame.exponent)};
}

// Returns whether a triangle `v` of a leaf blocks the ray. A filter that does not read the point is asked first,
// because it is cheaper than the rest.
inline bool is_blocked(const DualRay& ray, const FixedEnd& end, const HitFilter* filter, const TriangleBlock& block,
                       int lane, const FixedTriangle& v) {
  FixedRow z = depth_row(ray.fixed, v);
  if (z.low > end.limit || z.high < -4) return false;
  bool positive;
  FixedVerdict verdict = cross_fixed(ray.fixed, v, z, &positive);
  if (verdict == FixedVerdict::missed) return false;
  std::uint32_t triangle = block.triangle[lane];
  const bool early = filter && !filter->reads_point;
  if (early && !filter->accept(filter->context, triangle, 0, 0)) return false;
  if (verdict == FixedVerdict::crossed) {
    bool inside = end.sure.low <= z.low && z.high <= end.sure.high;
    FixedPlane plane;
    if (!inside && fixed_plane(ray.fixed, v, z, positive, &plane)) {
      if (surely_outside(plane, ray.fixed, z, end.limit)) return false;
      inside = surely_inside(plane, ray.fixed, z, end.sure);
    }
    if (inside && (!filter || early)) return true;
  }
  Crossing crossing;
  if (!locate(ray, block, lane, verdict, &crossing) || !(crossing.t > 0 && crossing.t < ray.t_max)) return false;
  return !filter || early || accepts(*filter, triangle, crossing);
}

// Calls visit(child, near, box) for each child of a node that a ray or hull does not miss up to the depth `limit`.
template <class Rays, class Visit>
inline void for_each_child(const BvhNode& node, const Rays& rays, const FixedFrame& frame, std::int32_t limit,
                           Visit visit) {
  for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
    FixedBox box;
    std::int32_t near;
    if (!misses(rays, ChildSlabs{node, lane, frame, &box}, limit, &near)) visit(node.child[lane], near, box);
  }
}

// Pushes a visit above those from `first` on that begin farther away.
template <class Visit>
inline void push_nearest_last(const Visit& visit, int first, Visit* stack, int* top) {
  int place = (*top)++;
  for (; place > first && stack[place - 1].near < visit.near; --place) stack[place] = stack[place - 1];
  stack[place] = visit;
}

template <class Tree>
void closest_of_ray(const FixedQuery<Tree>& query, const Ray& begin, Hit* hit) {
  hit->triangle = kNoTriangle;
  int of_class, exponent;
  FixedStart start = start_fixed(query, begin, &of_class, &exponent);
  if (start == FixedStart::in_floats) return closest<Tree>(query.accel, begin, query.filter, hit, query.stats);
  if (start == FixedStart::nothing) return;
  const FixedFrame frame = fixed_frame(of_class, exponent);
  DualRay ray;
  make_dual_ray(begin, frame, &ray);
  Counts counts;
  struct Visit {
    std::uint32_t child;
    std::int32_t near;
  } stack[kBvhStackSize];
  FixedBest best;
  begin_best(ray, frame, &best);
  TriangleBlock scratch;
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    Visit entry = stack[--top];
    if (entry.near > best.limit) continue;
    if (!(entry.child & kLeafBit)) {
      const BvhNode& node = query.tree.nodes[entry.child];
      ++counts.nodes;
      int first = top;
      for_each_child(node, ray.fixed, frame, best.limit, [&](std::uint32_t child, std::int32_t near, const FixedBox&) {
        push_nearest_last({child, near}, first, stack, &top);
      });
      continue;
    }
    const TriangleBlock& block = query.tree.leaf(entry.child, &scratch);
    int count = static_cast<int>(leaf_triangle_count(entry.child));
    counts.triangles += static_cast<std::uint32_t>(count);
    for (int lane = 0; lane < count; ++lane) {
      FixedTriangle v = fixed_triangle(block, lane, frame);
      improves(ray, frame, query.filter, block, lane, v, &best);
    }
  }
  add_counts(counts, query.stats);
  write_hit(best, hit);
}

template <class Tree>
bool occluded_ray(const FixedQuery<Tree>& query, const Ray& begin) {
  int of_class, exponent;
  FixedStart start = start_fixed(query, begin, &of_class, &exponent);
  if (start == FixedStart::in_floats) return occluded<Tree>(query.accel, begin, query.filter, query.stats);
  if (start == FixedStart::nothing) return false;
  const FixedFrame frame = fixed_frame(of_class, exponent);
  DualRay ray;
  make_dual_ray(begin, frame, &ray);
  Counts counts;
  std::uint32_t stack[kBvhStackSize];
  const FixedEnd end = end_of(ray, frame);
  TriangleBlock scratch;
  int top = 0;
  bool found = false;
  stack[top++] = 0;
  while (top > 0 && !found) {
    std::uint32_t child = stack[--top];
    if (!(child & kLeafBit)) {
      const BvhNode& node = query.tree.nodes[child];
      ++counts.nodes;
      for_each_child(node, ray.fixed, frame, end.limit,
                     [&](std::uint32_t met, std::int32_t, const FixedBox&) { stack[top++] = met; });
      continue;
    }
    const TriangleBlock& block = query.tree.leaf(child, &scratch);
    int count = static_cast<int>(leaf_triangle_count(child));
    counts.triangles += static_cast<std::uint32_t>(count);
    for (int lane = 0; lane < count && !found; ++lane) {
      if (joins(begin, block.triangle[lane])) continue;
      FixedTriangle v = fixed_triangle(block, lane, frame);
      found = is_blocked(ray, end, query.filter, block, lane, v);
    }
  }
  add_counts(counts, query.stats);
  return found;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
