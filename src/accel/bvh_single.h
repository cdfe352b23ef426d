// Single rays walk the BVH in the order in which they enter the boxes, four boxes or four triangles at a time. Part of
// the kernels: see bvh_kernels.h.
//
// A box must never hide a hit of its triangles. The slab test [Kay & Kajiya 1986] is therefore slackened, as [Ize 2013,
// JCGT 2(2)] asks, but by more than his 2 ulp of each distance: intersect_triangle() takes a ray for a hit that passes
// a triangle by up to 4u of the distance along the dominant axis at which the vertices lie (u = 2^-24: shear, two
// products and a difference), which may be larger than the distance of the hit. With Z the farthest such distance in
// the scene the errors of the triangle test (6u Z), of the slabs (3u) and of t itself (u) stay below 16u Z for each
// side of an interval.
#pragma once
#include <limits>

#include "accel/bvh.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

struct BoxRay {
  Float4 near_origin[3], far_origin[3], inverse[3];
  Float4 slack;     // 32u Z, in units of t
  int near_row[3];  // rows of BvhNode::bounds in which the ray enters; it leaves by the other row of the axis
  int exponent;     // boxes are entered at t · 2^exponent: keeps directions from 1e-45 to 1e38 in range
};

inline BoxRay make_box_ray(const ShearedRay& ray, const Box& bounds) {
  BoxRay r;
  Vec3 d = ray.direction;
  r.exponent = 0;
  float size = std::fabs(d[ray.kz]);
  if (!(size >= 0x1p-40f && size <= 0x1p40f)) {
    std::frexp(size, &r.exponent);
    for (int axis = 0; axis < 3; ++axis) d[axis] = std::ldexp(d[axis], -r.exponent);
    size = std::fabs(d[ray.kz]);
  }
  float o = ray.origin[ray.kz];
  float reach_low = std::fabs(bounds.low[ray.kz] - o), reach_high = std::fabs(bounds.high[ray.kz] - o);
  float reach = reach_low > reach_high ? reach_low : reach_high;  // Z
  // The powers of two below 2^-90 cover denormal rounding; they are relative to nothing, but boxes decide no result.
  r.slack = Float4::splat((reach * 0x1p-19f + 0x1p-100f) / size);
  for (int axis = 0; axis < 3; ++axis) {
    r.near_row[axis] = d[axis] < 0 ? axis + 3 : axis;
    float near = ray.origin[axis], far = near, inverse = 1 / d[axis];
    if (std::fabs(d[axis]) < size * 0x1p-40f) {
      // Parallel to the slab, or as good as: inside a slightly wider slab everywhere or nowhere. No 0·∞ arises.
      r.near_row[axis] = axis;
      float wider = (std::fabs(near) + reach) * 0x1p-20f + 0x1p-90f;
      near += wider, far -= wider, inverse = 0x1p44f / size;
    }
    r.near_origin[axis] = Float4::splat(near), r.far_origin[axis] = Float4::splat(far),
    r.inverse[axis] = Float4::splat(inverse);
  }
  return r;
}

// t as the boxes count it, not rounded down.
inline float box_distance(const BoxRay& ray, float t) {
  return ray.exponent == 0 ? t : std::ldexp(t, ray.exponent) + std::numeric_limits<float>::min();
}

// Mask of the children that may hold a hit before `t_max`; `entry` gets where each is entered, less the slack.
inline unsigned enter_boxes(const BoxRay& ray, const BvhNode& node, Float4 t_max, float* entry) {
  Float4 enter = Float4::splat(0), leave = t_max;
  for (int axis = 0; axis < 3; ++axis) {
    int row = ray.near_row[axis], other = row < 3 ? row + 3 : row - 3;
    enter = max((Float4::load(node.bounds[row]) - ray.near_origin[axis]) * ray.inverse[axis], enter);
    leave = min((Float4::load(node.bounds[other]) - ray.far_origin[axis]) * ray.inverse[axis], leave);
  }
  enter = enter - ray.slack;
  store(entry, enter);
  return bits(enter <= leave);
}

struct Entry {
  std::uint32_t child;
  float enter;
};

inline int lowest_bit(unsigned mask) { return __builtin_ctz(mask); }

// Pushes the entered children, the nearest last.
inline int push_children(const BvhNode& node, unsigned mask, const float* enter, Entry* stack, int top) {
  int first = top;
  for (; mask; mask &= mask - 1) {
    int lane = lowest_bit(mask), place = top++;
    for (; place > first && stack[place - 1].enter < enter[lane]; --place) stack[place] = stack[place - 1];
    stack[place] = {node.child[lane], enter[lane]};
  }
  return top;
}

// The state of one traversal.
template <bool kFiltered>
struct Search {
  ShearedRay ray;
  const HitFilter* filter;
  Hit best;
  float t_max;
};

// Tests the triangles of a leaf against the best hit so far. Returns whether it got better.
template <bool kFiltered>
bool search_leaf(Search<kFiltered>* search, const TriangleBlock& block, std::uint32_t count) {
  bool better = false;
  unsigned mask = filter_triangles(search->ray, block) & ((1u << count) - 1);
  for (; mask; mask &= mask - 1) {
    int lane = lowest_bit(mask);
    Hit hit;
    if (!intersect_triangle(search->ray, block_vertex(block, 0, lane), block_vertex(block, 1, lane),
                            block_vertex(block, 2, lane), &hit))
      continue;
    hit.triangle = block.triangle[lane];
    if (!(hit.t > 0 && hit.t < search->t_max)) continue;
    const Hit& best = search->best;
    if (best.triangle != kNoTriangle && !(hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle)))
      continue;
    if (kFiltered && !search->filter->accept(search->filter->context, hit.triangle, hit.u, hit.v)) continue;
    search->best = hit;
    better = true;
  }
  return better;
}

// Finds the closest hit, or with kAny some hit. search->best.triangle is kNoTriangle where there is none.
template <bool kFiltered, bool kAny>
void search_bvh(const Accel& accel, Search<kFiltered>* search, TraceStats* stats) {
  BvhView bvh(accel.data.data);
  BoxRay ray = make_box_ray(search->ray, accel.bounds);
  float t_box = box_distance(ray, search->t_max);
  std::uint64_t nodes = 0, triangles = 0;
  Entry stack[3 * kBvhDepthMax + 4];
  int top = 0;
  stack[top++] = {0, -std::numeric_limits<float>::infinity()};
  while (top > 0) {
    Entry entry = stack[--top];
    if (!(entry.enter <= t_box)) continue;
    if (entry.child & kLeafBit) {
      std::uint32_t count = leaf_triangle_count(entry.child);
      triangles += count;
      if (search_leaf(search, bvh.leaves[entry.child & kLeafIndexMask], count)) {
        if (kAny) break;
        t_box = box_distance(ray, search->best.t);
      }
    } else {
      const BvhNode& node = bvh.nodes[entry.child];
      ++nodes;
      alignas(16) float enter[4];
      unsigned mask = enter_boxes(ray, node, Float4::splat(t_box), enter);
      top = push_children(node, mask, enter, stack, top);
    }
  }
  if (stats) stats->nodes += nodes, stats->triangles += triangles;
}

template <bool kFiltered, bool kAny>
Hit find_hit(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  Search<kFiltered> search;
  search.best = {0, 0, 0, kNoTriangle};
  if (!(ray.t_max > 0) || is_empty(accel.bounds) || !make_sheared_ray(ray, &search.ray)) return search.best;
  search.filter = filter, search.t_max = ray.t_max;
  search_bvh<kFiltered, kAny>(accel, &search, stats);
  return search.best;
}

inline void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  bool filtered = filter && filter->accept;
  Hit found =
      filtered ? find_hit<true, false>(accel, ray, filter, stats) : find_hit<false, false>(accel, ray, filter, stats);
  hit->triangle = kNoTriangle;
  if (found.triangle != kNoTriangle) *hit = found;
}

inline bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  bool filtered = filter && filter->accept;
  Hit found =
      filtered ? find_hit<true, true>(accel, ray, filter, stats) : find_hit<false, true>(accel, ray, filter, stats);
  return found.triangle != kNoTriangle;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
