// Single rays traverse the BVH four boxes or four triangles at a time: front to back for the closest hit, in the order
// of the children for any hit. Part of the kernels: see bvh_kernels.h.
#pragma once
#include <cstring>

#include "accel/box_ray.h"
#include "accel/bvh_tree.h"
#include "accel/leaf_ray.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

struct Counts {
  std::uint64_t nodes = 0, triangles = 0;
};
inline void add_counts(const Counts& counts, TraceStats* stats) {
  if (stats) stats->nodes += counts.nodes, stats->triangles += counts.triangles;
}

// A ray prepared for traversal, and its best hit so far.
struct Search {
  LeafRay leaf;
  const HitFilter* filter;  // accept() is not null
  float t_max;
  float t;  // t of the best hit; t_max if none
  std::uint32_t triangle;
  double b, c, sum;        // weights of the best hit; with a filter …
  float u, v;              // … the quotients instead
  std::uint32_t from, to;  // as in Ray
};

// Returns false if there is nothing to hit.
inline bool start_search(const Accel& accel, const Ray& ray, const HitFilter* filter, Search* search, BoxRay* box) {
  Float4 origin = Float4::load3(&ray.origin.x), d = Float4::load3(&ray.direction.x), amount = abs(d);
  Float4 low = Float4::load3(&accel.bounds.low.x), high = Float4::load3(&accel.bounds.high.x);
  Mask4 valid = (abs(origin) <= Float4::splat(kOriginMax)) & (low <= high) &
                (amount <= Float4::splat(std::numeric_limits<float>::max()));
  if (bits(valid) != 15 || !(ray.t_max > 0)) return false;
  Float4 size = Float4::splat(highest(amount));
  const Axes* axes = &kAxesByGreatest[bits(amount == size) & 7];
  float greatest = first(size);
  box->exponent = 0;
  if (__builtin_expect(!(greatest >= 0x1p-20f && greatest <= 0x1p20f), 0)) {
    if (greatest == 0) return false;
    std::frexp(greatest, &box->exponent);
    Vec3 scaled;
    for (int axis = 0; axis < 3; ++axis) scaled[axis] = std::ldexp(ray.direction[axis], -box->exponent);
    d = Float4::load3(&scaled.x);
  }
  make_box_ray(origin, d, low, high, box);
  make_leaf_ray(ray, axes, &search->leaf);
  search->filter = filter;
  search->t = search->t_max = ray.t_max;
  search->triangle = kNoTriangle, search->from = ray.from, search->to = ray.to;
  return true;
}

inline unsigned lanes_in_use(std::uint32_t leaf_child) { return 15u >> (4 - leaf_triangle_count(leaf_child)); }

// Takes the best hit of the passing lanes if it beats the best so far, and returns whether it did. A separate function,
// so that it takes no registers from the node loop.
template <bool kFiltered>
__attribute__((noinline)) bool settle_leaf(Search* search, const TriangleBlock& block, unsigned pass,
                                           unsigned doubtful) {
  bool better = false;
  for_each_crossing(search->leaf, block, pass, doubtful, [&](int lane, const Crossing& crossing) {
    float t = crossing.t;
    std::uint32_t triangle = block.triangle[lane];
    if (!(t > 0 && (t < search->t || (t == search->t && triangle < search->triangle && t < search->t_max))))
      return false;
    if (kFiltered) {
      float u = static_cast<float>(crossing.b / crossing.sum), v = static_cast<float>(crossing.c / crossing.sum);
      if (!search->filter->accept(search->filter->context, triangle, u, v)) return false;
      search->u = u, search->v = v;
    } else {
      search->b = crossing.b, search->c = crossing.c, search->sum = crossing.sum;
    }
    search->t = t, search->triangle = triangle;
    better = true;
    return false;
  });
  if (better) bound_depth(&search->leaf, search->t);
  return better;
}

// Returns whether any triangle in the passing lanes is hit in (0, t_max).
template <bool kFiltered>
__attribute__((noinline)) bool any_crossing(const Search& search, const TriangleBlock& block, unsigned pass,
                                            unsigned doubtful) {
  return for_each_crossing(search.leaf, block, pass, doubtful, [&](int lane, const Crossing& crossing) {
    if (!(crossing.t > 0 && crossing.t < search.t_max)) return false;
    if (!kFiltered) return true;
    float u = static_cast<float>(crossing.b / crossing.sum), v = static_cast<float>(crossing.c / crossing.sum);
    return search.filter->accept(search.filter->context, block.triangle[lane], u, v);
  });
}

// A child to visit: its entry distance, above its reference. No distance is negative, so words sort like distances.
using Entry = std::uint64_t;
inline Entry make_entry(float enter, std::uint32_t child) {
  std::uint32_t distance;
  std::memcpy(&distance, &enter, sizeof distance);
  return static_cast<Entry>(distance) << 32 | child;
}
inline std::uint32_t child_of(Entry entry) { return static_cast<std::uint32_t>(entry); }
inline void sort_two(Entry* a, Entry* b) {
  Entry low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  *a = low, *b = high;
}

// Pushes all entered children (at least two) except the nearest, farthest first. Returns the nearest.
inline std::uint32_t push_farther(const BvhNode& node, unsigned mask, const float* enter, Entry** stack) {
  auto take = [&] {
    int lane = __builtin_ctz(mask);
    mask &= mask - 1;
    return make_entry(enter[lane], node.child[lane]);
  };
  Entry a = take(), b = take();
  if (!mask) {
    sort_two(&a, &b);
    *(*stack)++ = b;
    return child_of(a);
  }
  Entry c = take();
  sort_two(&a, &b), sort_two(&b, &c), sort_two(&a, &b);
  if (mask) {
    Entry d = take();
    sort_two(&c, &d), sort_two(&b, &c), sort_two(&a, &b);
    *(*stack)++ = d;
  }
  *(*stack)++ = c, *(*stack)++ = b;
  return child_of(a);
}

template <bool kFiltered, class Tree>
inline void search_closest(const Tree& bvh, const BoxRay& box, Search* search, TraceStats* stats) {
  Counts counts;
  TriangleBlock scratch;
  Entry stack[kBvhStackSize], *top = stack;
  Float4 limit = Float4::splat(box_limit(box.exponent, search->t));
  Entry last = make_entry(first(limit), ~0u);  // entries above this are not worth a visit
  std::uint32_t child = 0;
  for (;;) {
    while (__builtin_expect(!(child & kLeafBit), 1)) {
      const BvhNode& node = bvh.nodes[child];
      ++counts.nodes;
      Float4 entered;
      Mask4 miss = miss_boxes(box, node, limit, &entered);
      unsigned mask = bits(miss) ^ 15;
      if (!mask) goto next;
      child = word_outside(miss, node.child);
      if (mask & (mask - 1)) {
        alignas(16) float enter[4];
        store(enter, entered);
        child = push_farther(node, mask, enter, &top);
      }
    }
    {
      counts.triangles += leaf_triangle_count(child);
      const TriangleBlock& block = bvh.leaf(child, &scratch);
      LeafLanes lanes = test_leaf<false>(search->leaf, nullptr, block);
      lanes.pass &= lanes_in_use(child);
      if (lanes.pass && settle_leaf<kFiltered>(search, block, lanes.pass, lanes.doubtful)) {
        limit = Float4::splat(box_limit(box.exponent, search->t));
        last = make_entry(first(limit), ~0u);
      }
    }
  next:
    do {
      if (top == stack) return add_counts(counts, stats);
      child = child_of(*--top);
    } while (*top > last);
  }
}

// Removes the lanes of triangles at the ray's ends.
inline unsigned without_ends(const Search& search, const TriangleBlock& block, unsigned pass) {
  for (unsigned left = pass; left; left &= left - 1) {
    const std::uint32_t triangle = block.triangle[__builtin_ctz(left)];
    if (triangle == search.from || triangle == search.to) pass ^= left & (0 - left);
  }
  return pass;
}

template <bool kFiltered, class Tree>
inline bool search_any(const Tree& bvh, const BoxRay& box, const Search& search, TraceStats* stats) {
  Counts counts;
  TriangleBlock scratch;
  std::uint32_t stack[kBvhStackSize], *top = stack, child = 0;
  SureDepths sure = sure_depths(search.t_max, search.leaf.direction[2]);
  Float4 limit = Float4::splat(box_limit(box.exponent, search.t_max));
  bool found = false;
  for (;;) {
    while (__builtin_expect(!(child & kLeafBit), 1)) {
      const BvhNode& node = bvh.nodes[child];
      ++counts.nodes;
      Float4 entered;
      Mask4 miss = miss_boxes(box, node, limit, &entered);
      unsigned mask = bits(miss) ^ 15;
      if (!mask) goto next;
      if (mask & (mask - 1)) {
        child = node.child[__builtin_ctz(mask)];
        for (mask &= mask - 1; mask; mask &= mask - 1) *top++ = node.child[__builtin_ctz(mask)];
      } else {
        child = word_outside(miss, node.child);
      }
    }
    {
      counts.triangles += leaf_triangle_count(child);
      const TriangleBlock& block = bvh.leaf(child, &scratch);
      LeafLanes lanes = test_leaf<!kFiltered>(search.leaf, &sure, block);
      lanes.pass &= lanes_in_use(child);
      if (lanes.pass) lanes.pass = without_ends(search, block, lanes.pass);
      if (lanes.pass)
        found = (!kFiltered && (lanes.pass & lanes.sure)) ||
                any_crossing<kFiltered>(search, block, lanes.pass, lanes.doubtful);
    }
  next:
    if (found || top == stack) break;
    child = *--top;
  }
  add_counts(counts, stats);
  return found;
}

template <class Tree>
void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  Search search;
  BoxRay box;
  hit->triangle = kNoTriangle;
  if (!start_search(accel, ray, filter, &search, &box)) return;
  if (filter && filter->accept) {
    search_closest<true>(Tree(accel), box, &search, stats);
    if (search.triangle != kNoTriangle) *hit = {search.t, search.u, search.v, search.triangle};
  } else {
    search_closest<false>(Tree(accel), box, &search, stats);
    if (search.triangle == kNoTriangle) return;
    *hit = {search.t, static_cast<float>(search.b / search.sum), static_cast<float>(search.c / search.sum),
            search.triangle};
  }
}

template <class Tree>
bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  Search search;
  BoxRay box;
  if (!start_search(accel, ray, filter, &search, &box)) return false;
  Tree bvh(accel);
  return filter && filter->accept ? search_any<true>(bvh, box, search, stats)
                                  : search_any<false>(bvh, box, search, stats);
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
