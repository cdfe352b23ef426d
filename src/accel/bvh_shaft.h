// Segments that run close to one another, as those from a few pixels to one light, walk the BVH together, as the shaft
// that holds them. Like every kernel it is compiled once per instruction set, each time in a namespace of its own.
#pragma once
#include <cstring>
#include <utility>

#include "accel/axis_class.h"
#include "accel/bvh_tree.h"
#include "accel/shaft_leaf.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Mask of the children that the shaft of the whole bundle meets.
inline unsigned enter_boxes(const Bundle& b, const BvhNode& node) {
  const float *low_z = node.bounds[b.kz], *high_z = node.bounds[3 + b.kz];
  if (b.sign < 0) std::swap(low_z, high_z);
  auto relative = [&](const float* row, int k) { return Float4::load(row) - b.reference4[k]; };
  Float4 near = max(relative(low_z, 2) * b.sign4, b.all_begin), far = min(relative(high_z, 2) * b.sign4, b.all_end);
  auto at = [&](int row, Float4 z) { return b.at_zero[row] + b.slope[row] * z; };
  return bits((near <= far) & (min(at(0, near), at(0, far)) <= relative(node.bounds[3 + b.kx], 0)) &
              (relative(node.bounds[b.kx], 0) <= max(at(1, near), at(1, far))) &
              (min(at(2, near), at(2, far)) <= relative(node.bounds[3 + b.ky], 1)) &
              (relative(node.bounds[b.ky], 1) <= max(at(3, near), at(3, far))));
}

// Clears the bits of b->open whose segments something blocks.
template <int kLanes, class Tree>
void search_shaft(const Tree& bvh, Bundle* b, TraceStats* stats) {
  struct Place {
    std::uint32_t child, box;  // node · 4 + lane of its box
  };
  static_assert(kTriangleCountMax < 1u << 30, "there are fewer nodes than triangles");
  std::uint64_t nodes = 0, triangles = 0;
  Place stack[3 * kBvhDepthMax + 4];
  ShaftBatch batch;
  int top = 0;
  stack[top++] = {0, 0};
  for (;;) {
    if (batch.count == kShaftLeaves || (top == 0 && batch.count > 0)) search_shaft_leaves<kLanes>(b, &batch);
    if (top == 0 || !b->open) break;
    Place place = stack[--top];
    if (place.child & kLeafBit) {
      std::uint32_t count = leaf_triangle_count(place.child);
      triangles += count;
      batch.block[batch.count] = &bvh.leaf(place.child, &batch.scratch[batch.count]);
      batch.box[batch.count] = shaft_box(*b, bvh.nodes[place.box >> 2], static_cast<int>(place.box & 3));
      batch.in_use[batch.count++] = (1u << count) - 1;
      continue;
    }
    const BvhNode& node = bvh.nodes[place.child];
    ++nodes;
    for (unsigned mask = enter_boxes(*b, node); mask; mask &= mask - 1) {
      int lane = __builtin_ctz(mask);
      bvh.prefetch(node.child[lane]);
      stack[top++] = {node.child[lane], place.child * 4 + static_cast<std::uint32_t>(lane)};
    }
  }
  if (stats) stats->nodes += nodes, stats->triangles += triangles;
}

inline int axis_class(const Ray& ray) {
  return has_valid_origin(ray.origin) ? axis_class(ray.direction.x, ray.direction.y, ray.direction.z) : -1;
}

// Classes of all rays. Returns the set of those met.
inline unsigned classify(const SegmentPacket& rays, std::int8_t* classes) {
  unsigned met = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    classes[i] = static_cast<std::int8_t>(axis_class(ray_of(rays, i)));
    if (classes[i] >= 0) met |= 1u << classes[i];
  }
  return met;
}

// Whether all rays are surely of a class; the other axes of four at once must be strictly less.
inline bool all_of_class(const SegmentPacket& rays, int wanted, const Bundle& b) {
  Float4 sign = Float4::splat(b.sign), max_direction = Float4::splat(std::numeric_limits<float>::max());
  Float4 max_origin = Float4::splat(kOriginMax);
  std::uint32_t i = 0;
  for (; i + 4 <= rays.count; i += 4) {
    Float4 x = abs(Float4::load(rays.direction[b.kx] + i)), y = abs(Float4::load(rays.direction[b.ky] + i));
    Float4 z = Float4::load(rays.direction[b.kz] + i) * sign;
    Mask4 in_class = (x < z) & (y < z) & (z <= max_direction);
    for (const float* row : rays.origin) in_class = in_class & (abs(Float4::load(row + i)) <= max_origin);
    if (bits(in_class) != 15) return false;
  }
  for (; i < rays.count; ++i)
    if (axis_class(ray_of(rays, i)) != wanted) return false;
  return true;
}

// The segments of one class, by kx, ky, kz; of all where `classes` is null.
inline void gather_segments(const SegmentPacket& rays, const std::int8_t* classes, int wanted, Bundle* b) {
  const int axes[] = {b->kx, b->ky, b->kz};
  const float* from[] = {rays.origin[axes[0]],
                         rays.origin[axes[1]],
                         rays.origin[axes[2]],
                         rays.direction[axes[0]],
                         rays.direction[axes[1]],
                         rays.direction[axes[2]],
                         rays.t_max};
  float* to[] = {b->origin[0], b->origin[1], b->origin[2], b->direction[0], b->direction[1], b->direction[2], b->t_max};
  b->count = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i)
    if (!classes || classes[i] == wanted) b->place[b->count++] = static_cast<std::uint8_t>(i);
  int padded = (b->count + 15) & ~15;
  for (int row = 0; row < 7; ++row) {
    if (classes) {
      for (int n = 0; n < b->count; ++n) to[row][n] = from[row][b->place[n]];
    } else {
      std::memcpy(to[row], from[row], sizeof(float) * static_cast<std::size_t>(b->count));
    }
    for (int n = b->count; n < padded; ++n) to[row][n] = row < 6 ? to[row][b->count - 1] : -1.0f;
  }
}

template <class Tree, int kLanes>
std::uint64_t blocked_of_class(const Accel& accel, const SegmentPacket& rays, const std::int8_t* classes, int wanted,
                               Bundle* bundle, TraceStats* stats) {
  gather_segments(rays, classes, wanted, bundle);
  prepare_bundle(accel.bounds, bundle);
  std::uint64_t open = bundle->open, blocked = 0;
  search_shaft<kLanes>(Tree(accel), bundle, stats);
  if (!classes) return open & ~bundle->open;
  for (std::uint64_t m = open & ~bundle->open; m; m &= m - 1)
    blocked |= std::uint64_t(1) << bundle->place[__builtin_ctzll(m)];
  return blocked;
}

template <class Tree, int kLanes>
std::uint64_t occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                              TraceStats* stats) {
  if (is_empty(accel.bounds) || rays.count == 0) return 0;
  Bundle bundle;
  bundle.filter = filter && filter->accept ? filter : nullptr;
  int first = axis_class(ray_of(rays, 0));
  if (first >= 0) {
    set_axes(&bundle, first);
    if (all_of_class(rays, first, bundle))
      return blocked_of_class<Tree, kLanes>(accel, rays, nullptr, first, &bundle, stats);
  }
  std::int8_t classes[kPacketMax];
  std::uint64_t blocked = 0;
  for (unsigned met = classify(rays, classes); met; met &= met - 1) {
    set_axes(&bundle, __builtin_ctz(met));
    blocked |= blocked_of_class<Tree, kLanes>(accel, rays, classes, __builtin_ctz(met), &bundle, stats);
  }
  return blocked;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
