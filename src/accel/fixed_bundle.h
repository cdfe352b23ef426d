// Rays of one class traverse the BVH in integers together, by their hull; at a leaf, the rays that pass through its box
// are tested one by one. Part of the kernels: see bvh_fixed.h.
#pragma once
#include "accel/fixed_hull.h"
#include "accel/fixed_single.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kFixedGroup = 16, kFixedGroups = static_cast<int>(kPacketMax) / kFixedGroup;
static_assert(kFixedGroup <= 32 && kPacketMax % kFixedGroup == 0, "a bit of a word for each ray of a group");

// Rays in groups of sixteen, each with its own hull.
struct FixedBundle {
  FixedFrame frame;
  int count = 0, group_count;
  FixedHull all, group[kFixedGroups];
  std::uint32_t open[kFixedGroups];  // rays of a group still being traced
  std::int32_t start[kPacketMax];    // depth of the first plane of the hulls from the ray's origin: 0 or less
  DualRay ray[kPacketMax];
  std::uint8_t place[kPacketMax];  // index in the packet
  std::uint32_t from[kPacketMax];  // the triangle on which the ray begins, as in Ray
};

inline void add_ray(FixedBundle* b, const Ray& ray, std::uint32_t place) {
  make_dual_ray(ray, b->frame, &b->ray[b->count]);
  b->from[b->count] = ray.from, b->place[b->count++] = static_cast<std::uint8_t>(place);
}

// Sets everything but frame, count, ray and place. `limit` has the depths at which rays end.
inline void set_hulls(FixedBundle* b, const std::int32_t* limit) {
  std::int32_t near = b->ray[0].fixed.z, far = near;
  for (int i = 0; i < b->count; ++i) {
    std::int32_t z = b->ray[i].fixed.z;
    near = least(near, z), far = most(far, z + limit[i]);
  }
  std::int32_t length = least(far - near, kFixedMax);  // boxes end before 2^29
  float per_length = 1 / static_cast<float>(length);
  HullRange all_x, all_y;
  b->group_count = (b->count + kFixedGroup - 1) / kFixedGroup;
  for (int g = 0; g < b->group_count; ++g) {
    HullRange x, y;
    b->open[g] = 0;
    for (int i = kFixedGroup * g; i < least(kFixedGroup * (g + 1), b->count); ++i) {
      const FixedRay& ray = b->ray[i].fixed;
      b->start[i] = near - ray.z;
      std::int32_t end = b->start[i] + length;
      widen(&x, ray.x + part(b->start[i], ray.shear_x), ray.x + part(end, ray.shear_x));
      widen(&y, ray.y + part(b->start[i], ray.shear_y), ray.y + part(end, ray.shear_y));
      b->open[g] |= 1u << i % kFixedGroup;
    }
    b->group[g] = {near, length, hull_side(x, per_length), hull_side(y, per_length)};
    widen(&all_x, x), widen(&all_y, y);
  }
  b->all = {near, length, hull_side(all_x, per_length), hull_side(all_y, per_length)};
}

// Visits the rays of the bundle that pass through a leaf's box; limit_of(i) bounds the depth of ray i. visit(i) returns
// true if the ray needs no further search.
template <class Limit, class Visit>
inline void for_each_ray(FixedBundle* b, const FixedBox& box, std::int32_t limit, Limit limit_of, Visit visit) {
  const KeptSlabs slabs = {box};
  std::int32_t near;
  for (int g = 0; g < b->group_count; ++g) {
    if (!b->open[g] || misses(b->group[g], slabs, limit, &near)) continue;
    for (std::uint32_t open = b->open[g]; open; open &= open - 1) {
      int k = __builtin_ctz(open), i = kFixedGroup * g + k;
      if (misses(b->ray[i].fixed, slabs, limit_of(i), &near)) continue;
      if (visit(i)) b->open[g] &= ~(1u << k);
    }
  }
}

// A leaf in fixed point.
struct FixedLeaf {
  const TriangleBlock* block;
  int count;
  FixedTriangle triangle[kBvhLeafSize];
};
template <class Tree>
void convert_leaf(const Tree& tree, std::uint32_t child, const FixedFrame& frame, TriangleBlock* scratch,
                  FixedLeaf* leaf) {
  leaf->block = &tree.leaf(child, scratch), leaf->count = static_cast<int>(leaf_triangle_count(child));
  for (int lane = 0; lane < leaf->count; ++lane) leaf->triangle[lane] = fixed_triangle(*leaf->block, lane, frame);
}

template <class Tree>
void closest_in_bundle(const FixedQuery<Tree>& query, FixedBundle* b, Hit* hits) {
  Counts counts;
  struct Visit {
    std::uint32_t child;
    std::int32_t near;
    FixedBox box;
  } stack[kBvhStackSize];
  FixedBest best[kPacketMax];
  std::int32_t limits[kPacketMax];
  for (int i = 0; i < b->count; ++i) begin_best(b->ray[i], b->frame, &best[i]), limits[i] = best[i].limit;
  set_hulls(b, limits);
  std::int32_t limit = b->all.length;
  int top = 0;
  stack[top].child = 0, stack[top++].near = 0;
  while (top > 0) {
    const Visit entry = stack[--top];
    if (entry.near > limit) continue;
    if (!(entry.child & kLeafBit)) {
      const BvhNode& node = query.tree.nodes[entry.child];
      ++counts.nodes;
      int first = top;
      for_each_child(node, b->all, b->frame, limit, [&](std::uint32_t child, std::int32_t near, const FixedBox& box) {
        push_nearest_last({child, near, box}, first, stack, &top);
      });
      continue;
    }
    TriangleBlock scratch;
    FixedLeaf leaf;
    leaf.count = 0;
    bool better = false;
    for_each_ray(
        b, entry.box, limit, [&](int i) { return best[i].limit; },
        [&](int i) {
          if (leaf.count == 0) convert_leaf(query.tree, entry.child, b->frame, &scratch, &leaf);
          counts.triangles += static_cast<std::uint32_t>(leaf.count);
          for (int lane = 0; lane < leaf.count; ++lane)
            better |= improves(b->ray[i], b->frame, query.filter, *leaf.block, lane, leaf.triangle[lane], &best[i]);
          return false;
        });
    if (!better) continue;
    limit = 0;
    for (int i = 0; i < b->count; ++i) limit = most(limit, best[i].limit - b->start[i]);
    limit = least(limit, b->all.length);
  }
  add_counts(counts, query.stats);
  for (int i = 0; i < b->count; ++i) write_hit(best[i], &hits[b->place[i]]);
}

template <class Tree>
std::uint64_t occluded_in_bundle(const FixedQuery<Tree>& query, FixedBundle* b) {
  Counts counts;
  std::uint32_t stack[kBvhStackSize];
  FixedEnd end[kPacketMax];
  std::int32_t limits[kPacketMax];
  for (int i = 0; i < b->count; ++i) end[i] = end_of(b->ray[i], b->frame), limits[i] = end[i].limit;
  set_hulls(b, limits);
  std::uint64_t blocked = 0;
  int top = 0, open_count = b->count;
  stack[top++] = 0;
  while (top > 0 && open_count > 0) {
    const BvhNode& node = query.tree.nodes[stack[--top]];
    ++counts.nodes;
    for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
      FixedBox box;
      std::int32_t near;
      const std::uint32_t child = node.child[lane];
      if (misses(b->all, ChildSlabs{node, lane, b->frame, &box}, b->all.length, &near)) continue;
      if (!(child & kLeafBit)) {
        stack[top++] = child;
        continue;
      }
      TriangleBlock scratch;
      FixedLeaf leaf;
      leaf.count = 0;
      for_each_ray(
          b, box, b->all.length, [&](int i) { return end[i].limit; },
          [&](int i) {
            if (leaf.count == 0) convert_leaf(query.tree, child, b->frame, &scratch, &leaf);
            counts.triangles += static_cast<std::uint32_t>(leaf.count);
            bool found = false;
            for (int at = 0; at < leaf.count && !found; ++at)
              found = leaf.block->triangle[at] != b->from[i] &&
                      is_blocked(b->ray[i], end[i], query.filter, *leaf.block, at, leaf.triangle[at]);
            if (found) blocked |= std::uint64_t{1} << b->place[i], --open_count;
            return found;
          });
    }
  }
  add_counts(counts, query.stats);
  return blocked;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
