// Shadow rays that run to one point or along one direction, prepared for joint traversal of the BVH. Part of the
// kernels: see bvh_shaft.h.
//
// Such rays are points q of a plane: the plane at depth 1 from the point they run to, or across the direction they
// share. Depths are counted along their dominant axis from there, against the rays, so that a ray begins at the largest
// of its depths. Boxes are rectangles of the plane; the shaft [Haines & Wallace 1994] of some rays is the rectangle
// that contains them.
//
// How far rectangles are widened: let Z be the largest coordinate of scene and origins relative to the point, or to the
// first origin. cross_triangle() accepts hits of rays that miss the triangle by up to 4u of the depth of its vertices
// (u = 2^-24), at most 2Z; differences and slopes here err by less than 8u Z. 32u Z = 2^-19 Z covers both. Rays need
// not meet in the point exactly: each coordinate of their ends may be off by `spread`, and by twice that at the depth
// of the point, since |q| ≤ 1. Rays that begin at depths near the spread appear at q that err by more; eight times the
// spread covers both. (Shading moves origins off their surfaces by a few ulp, which is all the spread there is.) The q
// themselves err by less than kPacketSlack.
#pragma once
#include "accel/bvh.h"
#include "accel/packet.h"
#include "base/box.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kRays = static_cast<int>(kPacketMax), kGroups = kRays / 4;

// The rays of a packet with the same dominant axis and sign of direction. Arrays by axis are by kx, ky, kz. A group is
// four rays, a block four groups.
struct Bundle {
  int kx, ky, kz;
  float sign;             // of the directions along kz
  int count;              // of rays; arrays are padded to a multiple of sixteen
  bool converges;         // to a point; else the rays are parallel
  float middle[3];        // the point; else the first origin
  float slope[2];         // parallel: how x and y change with depth
  bool has_bounds;        // whether low and high are set
  float low[3], high[3];  // bounds of the origins
  float slack;            // 2^-19 Z and eight times the spread
  bool cubes_are_finite;  // cubes of coordinates are finite
  const HitFilter* filter;
  std::uint64_t open;  // rays not yet found to be blocked
  std::uint8_t place[kRays];
  std::uint32_t from[kRays];  // the triangles on which rays begin, as in Ray
  alignas(64) float origin[3][kRays], direction[3][kRays], t_max[kRays];
  alignas(64) float shear_x[kRays], shear_y[kRays];  // as in make_sheared_ray()
  // Coordinate differences along kz from the origin: between hit_low and hit_high a hit counts; a triangle between
  // sure_low and sure_high certainly has t in (0, t_max).
  alignas(64) float hit_low[kRays], hit_high[kRays], sure_low[kRays], sure_high[kRays];
  alignas(64) float x[kRays], y[kRays];  // q
  alignas(64) float depth[kRays];        // where the ray begins; less than all others if it hits nothing
  alignas(64) float group_depth[kGroups];
  Windows4 block, group[4];
  Float4 window[4];  // of all rays, in all lanes: low and high x, low and high y
  float all_depth;
};

inline int padded_count(const Bundle& b) { return (b.count + 15) & ~15; }

// Determines how the rays are bundled. Returns false if they neither meet in a point nor run parallel.
inline bool find_middle(Bundle* b) {
  Float4 spread = Float4::splat(0), reach = spread, longest = spread, turn = spread;
  Float4 first[3], end[3];
  for (int k = 0; k < 3; ++k) {
    first[k] = Float4::splat(b->direction[k][0]);
    end[k] = Float4::splat(b->origin[k][0] + b->direction[k][0]);
  }
  for (int i = 0; i < padded_count(*b); i += 4) {
    for (int k = 0; k < 3; ++k) {
      Float4 origin = Float4::load(b->origin[k] + i), direction = Float4::load(b->direction[k] + i);
      spread = max(spread, abs(origin + direction - end[k])), reach = max(reach, abs(direction));
      turn = max(turn, abs(direction - first[k]));
    }
    longest = max(longest, Float4::load(b->t_max + i));
  }
  b->slope[0] = b->slope[1] = 0, b->has_bounds = false;
  // Within this reach the slack stays below no_child_box(); with more spread hardly anything could be skipped.
  b->converges =
      highest(longest) <= 1 && highest(reach) <= 8 * kCoordinateMax && highest(spread) <= highest(reach) * 0x1p-12f;
  b->slack = b->converges ? 8 * highest(spread) : 0;
  for (int k = 0; k < 3; ++k) b->middle[k] = b->origin[k][0] + (b->converges ? b->direction[k][0] : 0);
  if (b->converges || highest(turn) > 0) return b->converges;
  for (int k = 0; k < 2; ++k) b->slope[k] = b->direction[k][0] / b->direction[2][0] * -b->sign;
  return true;
}

// Adds the contribution of the largest coordinate to the slack.
inline void set_slack(const Box& bounds, Bundle* b) {
  const int axes[] = {b->kx, b->ky, b->kz};
  Float4 reach = Float4::splat(0);
  for (int k = 0; k < 3; ++k) {
    Float4 middle = Float4::splat(b->middle[k]);
    reach = max(reach, abs(Float4::splat(bounds.low[axes[k]]) - middle));
    reach = max(reach, abs(Float4::splat(bounds.high[axes[k]]) - middle));
    for (int i = 0; i < padded_count(*b); i += 4) reach = max(reach, abs(Float4::load(b->origin[k] + i) - middle));
  }
  // Up to here the sums of products of an edge function, below 3e25, times depths stay below 2e38.
  b->cubes_are_finite = highest(reach) < 1e12f;
  b->slack += highest(reach) * 0x1p-19f + std::numeric_limits<float>::min();
}

// Depths within which t neither overflows nor rounds to 0 or to t_max. Excludes denormals, which slow the CPU down.
struct CertainDepths {
  Float4 near, far;
};
inline CertainDepths certain_depths(Float4 t_max, Float4 direction_z) {
  Float4 size = abs(direction_z), tiny = Float4::splat(0x1p-80f);
  Float4 far = min(t_max, Float4::splat(std::numeric_limits<float>::max())) * size * Float4::splat(1 - 0x1p-20f);
  return {(size + Float4::splat(1)) * tiny, select(tiny <= far, far, Float4::splat(0))};
}

// Sets the windows of the groups, of the blocks and of all rays.
inline void set_windows(Bundle* b) {
  constexpr Window kNowhere = {1e30f, -1e30f, 1e30f, -1e30f};
  b->all_depth = -kInfinity;
  for (int g = 0; g < kGroups; ++g) {
    b->group_depth[g] = -kInfinity;
    set_window(&b->group[g / 4], g % 4, kNowhere);
    if (4 * g >= b->count) continue;
    Float4 x = Float4::load(b->x + 4 * g), y = Float4::load(b->y + 4 * g);
    set_window(&b->group[g / 4], g % 4, {lowest(x), highest(x), lowest(y), highest(y)});
    b->group_depth[g] = highest(Float4::load(b->depth + 4 * g));
    b->all_depth = b->group_depth[g] > b->all_depth ? b->group_depth[g] : b->all_depth;
  }
  for (int block = 0; block < 4; ++block) set_window(&b->block, block, hull(b->group[block]));
  Window all = hull(b->block);
  b->window[0] = Float4::splat(all.x_low), b->window[1] = Float4::splat(all.x_high);
  b->window[2] = Float4::splat(all.y_low), b->window[3] = Float4::splat(all.y_high);
}

// Computes everything from axes, filter, count, place and the padded origin, direction and t_max, for rays of one class
// with valid origins. Returns false if they form no bundle.
inline bool prepare_bundle(const Box& bounds, Bundle* b) {
  if (!find_middle(b)) return false;
  set_slack(bounds, b);
  Float4 zero = Float4::splat(0), sign = Float4::splat(b->sign);
  bool back = b->sign < 0;
  b->open = 0;
  for (int i = 0; i < padded_count(*b); i += 4) {
    Float4 dz = Float4::load(b->direction[2] + i), t_max = Float4::load(b->t_max + i);
    store(b->shear_x + i, Float4::load(b->direction[0] + i) / dz);
    store(b->shear_y + i, Float4::load(b->direction[1] + i) / dz);
    Float4 x = Float4::load(b->origin[0] + i) - Float4::splat(b->middle[0]);
    Float4 y = Float4::load(b->origin[1] + i) - Float4::splat(b->middle[1]);
    Float4 depth = (Float4::splat(b->middle[2]) - Float4::load(b->origin[2] + i)) * sign;
    if (b->converges) {
      Float4 inverse = reciprocal(max(depth, Float4::splat(b->slack)));
      store(b->x + i, x * inverse), store(b->y + i, y * inverse);
    } else {
      store(b->x + i, x - depth * Float4::splat(b->slope[0])), store(b->y + i, y - depth * Float4::splat(b->slope[1]));
    }
    Mask4 open = zero < t_max;
    b->open |= static_cast<std::uint64_t>(bits(open)) << i;
    store(b->depth + i, select(open, depth + Float4::splat(b->slack), Float4::splat(-kInfinity)));
    Float4 bound = depth_bound(t_max, dz);
    CertainDepths sure = certain_depths(t_max, dz);
    store(b->hit_low + i, back ? zero - bound : zero), store(b->hit_high + i, back ? zero : bound);
    store(b->sure_low + i, back ? zero - sure.far : sure.near);
    store(b->sure_high + i, back ? zero - sure.near : sure.far);
  }
  set_windows(b);
  return true;
}

inline void find_bounds(Bundle* b) {
  for (int k = 0; k < 3; ++k) {
    Float4 low = Float4::load(b->origin[k]), high = low;
    for (int i = 4; i < padded_count(*b); i += 4) {
      const Float4 origin = Float4::load(b->origin[k] + i);
      low = min(low, origin), high = max(high, origin);
    }
    b->low[k] = lowest(low), b->high[k] = highest(high);
  }
  b->has_bounds = true;
}

// Boxes projected to the plane, four at a time, and their nearest depths.
struct Rectangles4 {
  Float4 x_low, x_high, y_low, y_high, near, far;
};

// Projects the children of a node.
inline Rectangles4 project_children(const Bundle& b, const BvhNode& node) {
  auto row = [&](int side, int axis, int k) {
    return Float4::load(node.bounds[side + axis]) - Float4::splat(b.middle[k]);
  };
  Float4 sign = Float4::splat(-b.sign), slack = Float4::splat(b.slack);
  Float4 x_low = row(0, b.kx, 0) - slack, x_high = row(3, b.kx, 0) + slack;
  Float4 y_low = row(0, b.ky, 1) - slack, y_high = row(3, b.ky, 1) + slack;
  Float4 near = row(b.sign < 0 ? 0 : 3, b.kz, 2) * sign, far = row(b.sign < 0 ? 3 : 0, b.kz, 2) * sign;
  Float4 deepest = min(far, Float4::splat(b.all_depth));  // no ray has begun beyond it
  if (!b.converges) {
    Float4 slope_x = Float4::splat(b.slope[0]), slope_y = Float4::splat(b.slope[1]);
    Float4 x0 = slope_x * near, x1 = slope_x * deepest, y0 = slope_y * near, y1 = slope_y * deepest;
    return {x_low - max(x0, x1),     x_high - min(x0, x1), y_low - max(y0, y1), y_high - min(y0, y1), near,
            Float4::splat(kInfinity)};
  }
  Float4 tiny = Float4::splat(std::numeric_limits<float>::min());
  Float4 widen = Float4::splat(kPacketSlack), a = reciprocal(max(near, tiny)), c = reciprocal(max(deepest, tiny));
  return {min(x_low * a, x_low * c) - widen,
          max(x_high * a, x_high * c) + widen,
          min(y_low * a, y_low * c) - widen,
          max(y_high * a, y_high * c) + widen,
          near,
          far + slack};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
