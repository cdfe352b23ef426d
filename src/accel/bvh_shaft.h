// Shadow rays from a few pixels to one light, or along one direction, traverse the BVH together, as the shaft that
// contains them. Like every kernel, compiled once per instruction set, in a namespace of its own.
#pragma once
#include <cstring>

#include "accel/axis_class.h"
#include "accel/bvh_single.h"
#include "accel/shaft_leaf.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Clears the bits of b->open whose rays are blocked.
template <int kLanes, class Tree>
void search_shaft(const Tree& bvh, Bundle* b, TraceStats* stats) {
  std::uint64_t nodes = 0, triangles = 0;
  std::uint32_t stack[kBvhStackSize];
  ShaftBatch batch;
  int top = 0;
  stack[top++] = 0;
  while (top > 0 && b->open) {
    const BvhNode& node = bvh.nodes[stack[--top]];
    ++nodes;
    Rectangles4 r = project_children(*b, node);
    Mask4 met = (r.x_low <= b->window[1]) & (b->window[0] <= r.x_high) & (r.y_low <= b->window[3]) &
                (b->window[2] <= r.y_high) & (r.near <= Float4::splat(b->all_depth)) & (Float4::splat(0) <= r.far);
    alignas(16) float x_low[4], x_high[4], y_low[4], y_high[4], near[4];
    store(x_low, r.x_low), store(x_high, r.x_high), store(y_low, r.y_low), store(y_high, r.y_high), store(near, r.near);
    for (unsigned mask = bits(met); mask; mask &= mask - 1) {
      int lane = __builtin_ctz(mask);
      std::uint32_t child = node.child[lane];
      bvh.prefetch(child);
      if (!(child & kLeafBit)) {
        stack[top++] = child;
        continue;
      }
      triangles += leaf_triangle_count(child);
      batch.child[batch.count] = child, batch.near[batch.count] = near[lane];
      batch.window[batch.count++] = {x_low[lane], x_high[lane], y_low[lane], y_high[lane]};
      if (batch.count == kShaftLeaves) search_shaft_leaves<kLanes>(bvh, b, &batch);
    }
  }
  if (batch.count > 0) search_shaft_leaves<kLanes>(bvh, b, &batch);
  if (stats) stats->nodes += nodes, stats->triangles += triangles;
}

// Returns the class of a shadow ray; −1 also if its origin is too far out to hit anything.
inline int segment_class(const Ray& ray) {
  return has_valid_origin(ray.origin) ? axis_class(ray.direction.x, ray.direction.y, ray.direction.z) : -1;
}

// Classifies all rays and returns the set of classes that occur.
inline unsigned classify(const SegmentPacket& rays, std::int8_t* classes) {
  unsigned met = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    classes[i] = static_cast<std::int8_t>(segment_class(ray_of(rays, i)));
    if (classes[i] >= 0) met |= 1u << classes[i];
  }
  return met;
}

// Returns whether all rays certainly belong to a class; the other axes of all four at once must be strictly smaller.
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
    if (segment_class(ray_of(rays, i)) != wanted) return false;
  return true;
}

// Gathers the segments of one class, by kx, ky, kz; all segments if `classes` is null.
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
  for (int n = 0; n < b->count; ++n) b->from[n] = rays.from[b->place[n]];
  int padded = padded_count(*b);
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
  std::uint64_t blocked = 0;
  if (!prepare_bundle(accel.bounds, bundle)) {
    for (int n = 0; n < bundle->count; ++n)
      blocked |=
          static_cast<std::uint64_t>(occluded<Tree>(accel, ray_of(rays, bundle->place[n]), bundle->filter, stats))
          << bundle->place[n];
    return blocked;
  }
  std::uint64_t open = bundle->open;
  search_shaft<kLanes>(Tree(accel), bundle, stats);
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
  int first = segment_class(ray_of(rays, 0));
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
