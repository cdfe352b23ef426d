// Single rays walk the BVH, four boxes or four triangles at a time: for the closest hit in the order in which they
// enter the boxes, for any hit in the order of the children. Part of the kernels: see bvh_kernels.h.
#pragma once
#include <cstring>

#include "accel/box_ray.h"
#include "accel/leaf_ray.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kStackSize = 3 * kBvhDepthMax + 4;

struct Counts {
  std::uint64_t nodes = 0, triangles = 0;
};
inline void add_counts(const Counts& counts, TraceStats* stats) {
  if (stats) stats->nodes += counts.nodes, stats->triangles += counts.triangles;
}

// A ray made ready, and the best hit so far.
struct Search {
  BoxRay box;
  LeafRay leaf;
  const HitFilter* filter;  // with an accept()
  float t_max;
  float t;  // of the best hit; t_max where there is none
  std::uint32_t triangle;
  double b, c, sum;  // its weights; with a filter …
  float u, v;        // … instead, divided already
};

// False where there is nothing to hit.
inline bool start_search(const Accel& accel, const Ray& ray, const HitFilter* filter, Search* search) {
  if (!(ray.t_max > 0) || is_empty(accel.bounds) || !make_sheared_ray(ray, &search->leaf.sheared)) return false;
  make_box_ray(ray, search->leaf.sheared.kz, accel.bounds, &search->box);
  make_leaf_ray(ray, &search->leaf);
  search->filter = filter;
  search->t = search->t_max = ray.t_max;
  search->triangle = kNoTriangle;
  return true;
}

inline const TriangleBlock& leaf_of(const BvhView& bvh, std::uint32_t child) {
  return bvh.leaves[child & kLeafIndexMask];
}
inline unsigned lanes_in_use(std::uint32_t leaf_child) { return 15u >> (4 - leaf_triangle_count(leaf_child)); }

// Takes what is nearer than the best hit so far. Returns whether there was any.
template <bool kFiltered>
bool search_leaf(Search* search, const TriangleBlock& block, unsigned in_use) {
  LeafLanes lanes = test_leaf<false>(search->leaf, block);
  lanes.pass &= in_use;
  if (!lanes.pass) return false;
  bool better = false;
  for_each_crossing(search->leaf, block, lanes, [&](int lane, const Crossing& crossing) {
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

// Whether any triangle of the leaf is hit in (0, t_max).
template <bool kFiltered>
bool any_in_leaf(const Search& search, const TriangleBlock& block, unsigned in_use) {
  LeafLanes lanes = test_leaf<!kFiltered>(search.leaf, block);
  lanes.pass &= in_use;
  if (!lanes.pass) return false;
  if (!kFiltered && lanes.sure) return true;
  return for_each_crossing(search.leaf, block, lanes, [&](int lane, const Crossing& crossing) {
    if (!(crossing.t > 0 && crossing.t < search.t_max)) return false;
    if (!kFiltered) return true;
    float u = static_cast<float>(crossing.b / crossing.sum), v = static_cast<float>(crossing.c / crossing.sum);
    return search.filter->accept(search.filter->context, block.triangle[lane], u, v);
  });
}

// A child to be visited: where it is entered, above its reference. No distance is negative, so words sort as distances.
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

// Pushes the entered children, at least two, but for the nearest, the farthest first. Returns the nearest.
inline std::uint32_t push_farther(const BvhView& bvh, const BvhNode& node, unsigned mask, const float* enter,
                                  Entry** stack) {
  auto take = [&] {
    int lane = __builtin_ctz(mask);
    mask &= mask - 1;
    prefetch(bvh, node.child[lane]);
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

template <bool kFiltered>
void search_closest(const BvhView& bvh, Search* search, TraceStats* stats) {
  Counts counts;
  Entry stack[kStackSize], *top = stack;
  const BoxRay box = search->box;  // a copy stays in registers
  float limit = box_limit(box, search->t);
  Entry last = make_entry(limit, ~0u);  // what is worth a visit is not above
  std::uint32_t child = 0;
  for (;;) {
    while (!(child & kLeafBit)) {
      const BvhNode& node = bvh.nodes[child];
      ++counts.nodes;
      alignas(16) float enter[4];
      unsigned mask = enter_boxes(box, node, Float4::splat(limit), enter);
      if (!mask) goto next;
      child = mask & (mask - 1) ? push_farther(bvh, node, mask, enter, &top) : node.child[__builtin_ctz(mask)];
    }
    counts.triangles += leaf_triangle_count(child);
    if (search_leaf<kFiltered>(search, leaf_of(bvh, child), lanes_in_use(child))) {
      limit = box_limit(box, search->t);
      last = make_entry(limit, ~0u);
    }
  next:
    do {
      if (top == stack) return add_counts(counts, stats);
      child = child_of(*--top);
    } while (*top > last);
  }
}

template <bool kFiltered>
bool search_any(const BvhView& bvh, const Search& search, TraceStats* stats) {
  Counts counts;
  std::uint32_t stack[kStackSize], *top = stack, child = 0;
  const BoxRay box = search.box;  // a copy stays in registers
  Float4 limit = Float4::splat(box_limit(box, search.t_max));
  for (bool found = false;;) {
    if (child & kLeafBit) {
      counts.triangles += leaf_triangle_count(child);
      found = any_in_leaf<kFiltered>(search, leaf_of(bvh, child), lanes_in_use(child));
    } else {
      const BvhNode& node = bvh.nodes[child];
      ++counts.nodes;
      alignas(16) float enter[4];
      unsigned mask = enter_boxes(box, node, limit, enter);
      if (mask) {
        child = node.child[__builtin_ctz(mask)];
        for (mask &= mask - 1; mask; mask &= mask - 1) {
          *top = node.child[__builtin_ctz(mask)];
          ++top;
        }
        continue;
      }
    }
    if (found || top == stack) {
      add_counts(counts, stats);
      return found;
    }
    child = *--top;
  }
}

inline void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  Search search;
  hit->triangle = kNoTriangle;
  if (!start_search(accel, ray, filter, &search)) return;
  if (filter && filter->accept) {
    search_closest<true>(BvhView(accel.data.data), &search, stats);
    if (search.triangle != kNoTriangle) *hit = {search.t, search.u, search.v, search.triangle};
  } else {
    search_closest<false>(BvhView(accel.data.data), &search, stats);
    if (search.triangle == kNoTriangle) return;
    *hit = {search.t, static_cast<float>(search.b / search.sum), static_cast<float>(search.c / search.sum),
            search.triangle};
  }
}

inline bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  Search search;
  if (!start_search(accel, ray, filter, &search)) return false;
  BvhView bvh(accel.data.data);
  return filter && filter->accept ? search_any<true>(bvh, search, stats) : search_any<false>(bvh, search, stats);
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
