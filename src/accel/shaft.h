// Segments on their way through the BVH together. Part of the kernels: see bvh_shaft.h.
//
// Seen along the dominant axis of their directions, at depth z, a segment is the point q(z) = q0 + z·slope, linear in
// z. So is the chord between the greatest q at two depths, and no segment of a bundle lies beyond it in between: that
// is the shaft [Haines & Wallace 1994], for us two lines a side instead of planes. Segments to one light make a
// pyramid, segments along one direction a prism, without being told apart.
//
// Depths and positions are relative to the first origin. How far shafts and boxes are widened: with Z the greatest of
// such coordinates of scene and origins, cross_triangle() takes a segment for a hit that passes the triangle by up to
// 4u of the depth at which its vertices lie (u = 2^-24), at most 2Z; lines, windows and boxes here err by less than 24u
// Z and t by u. 64u Z = 2^-18 Z covers all.
#pragma once
#include "accel/packet.h"
#include "accel/triangle.h"
#include "base/box.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kRays = static_cast<int>(kPacketMax), kBlocks = 4, kBlockRays = kRays / kBlocks;

// Where a segment begins, and less that where it ends, that hits nothing: finite, so that no difference is a NaN.
constexpr float kNowhere = 16 * kCoordinateMax;

// Four shafts, one a lane. Rows: low x, high x, low y, high y.
struct alignas(16) Shafts4 {
  float at_zero[4][4], slope[4][4];
  float begin[4], end[4];  // depths
};

// The segments of a bundle that share the dominant axis and sign of direction; rows by kx, ky, kz.
struct Bundle {
  int kx, ky, kz;
  float sign;  // of the directions along kz
  int count;   // of segments; the arrays are padded to a multiple of sixteen
  const HitFilter* filter;
  bool cubes_are_finite;  // of coordinates
  float reference[3];     // by kx, ky, kz
  float slack;            // 64u Z
  std::uint64_t open;     // segments not found to be blocked
  std::uint8_t place[kRays];
  alignas(64) float origin[3][kRays], direction[3][kRays], t_max[kRays];
  alignas(64) float shear_x[kRays], shear_y[kRays];                      // as make_sheared_ray() has them
  alignas(64) float x[kRays], y[kRays], slope_x[kRays], slope_y[kRays];  // q(z)
  alignas(64) float begin[kRays], end[kRays];                            // depths between which a hit counts
  alignas(64) float low[kRays], high[kRays];  // the same as differences of coordinates along kz from the origin …
  alignas(64) float sure_low[kRays], sure_high[kRays];  // … and where a triangle between them surely lies in (0, t_max)
  Shafts4 block;                                        // sixteen segments a lane
  Float4 at_zero[4], slope[4], all_begin, all_end, sign4, reference4[3];  // of all segments, the same in all lanes
};

// Bounds the segments [first, last) in one lane.
inline void set_shaft(const Bundle& b, int first, int last, int lane, Shafts4* shafts) {
  Float4 infinity = Float4::splat(kInfinity), minus = Float4::splat(-kInfinity), nearest = infinity, deepest = minus;
  for (int i = first; i < last; i += 4)
    nearest = min(nearest, Float4::load(b.begin + i)), deepest = max(deepest, Float4::load(b.end + i));
  float begin = lowest(nearest), end = highest(deepest);
  shafts->begin[lane] = begin, shafts->end[lane] = end;
  if (!(begin <= end)) {  // nothing to hit
    for (int row = 0; row < 4; ++row) shafts->slope[row][lane] = shafts->at_zero[row][lane] = 0;
    return;
  }
  Float4 near = Float4::splat(begin), far = Float4::splat(end);
  Float4 at_begin[] = {infinity, minus, infinity, minus}, at_end[] = {infinity, minus, infinity, minus};
  for (int i = first; i < last; i += 4) {
    Float4 slope_x = Float4::load(b.slope_x + i), slope_y = Float4::load(b.slope_y + i);
    Float4 x = Float4::load(b.x + i), y = Float4::load(b.y + i);
    Float4 x0 = x + slope_x * near, x1 = x + slope_x * far, y0 = y + slope_y * near, y1 = y + slope_y * far;
    Mask4 open = Float4::load(b.begin + i) <= Float4::load(b.end + i);
    auto low = [&](Float4 q) { return select(open, q, infinity); };
    auto high = [&](Float4 q) { return select(open, q, minus); };
    at_begin[0] = min(at_begin[0], low(x0)), at_begin[1] = max(at_begin[1], high(x0));
    at_begin[2] = min(at_begin[2], low(y0)), at_begin[3] = max(at_begin[3], high(y0));
    at_end[0] = min(at_end[0], low(x1)), at_end[1] = max(at_end[1], high(x1));
    at_end[2] = min(at_end[2], low(y1)), at_end[3] = max(at_end[3], high(y1));
  }
  // A chord's slope is at most 1, and rounded little where its ends are not too close; else more slack covers it.
  bool is_short = !(end - begin > b.slack);
  float inverse = is_short ? 0 : 1 / (end - begin), slack = is_short ? 2 * b.slack : b.slack;
  for (int row = 0; row < 4; ++row) {
    bool high = row & 1;
    float first_value = high ? highest(at_begin[row]) + slack : lowest(at_begin[row]) - slack;
    float last_value = high ? highest(at_end[row]) + slack : lowest(at_end[row]) - slack;
    shafts->slope[row][lane] = (last_value - first_value) * inverse;
    shafts->at_zero[row][lane] = first_value - shafts->slope[row][lane] * begin;
  }
}

// The shafts of the segments that are open.
inline void set_shafts(Bundle* b) {
  int padded = (b->count + 15) & ~15;
  for (int block = 0; block < kBlocks; ++block) {
    bool any = block * kBlockRays < padded;
    set_shaft(*b, any ? block * kBlockRays : 0, any ? (block + 1) * kBlockRays : padded, block, &b->block);
    if (!any) b->block.begin[block] = kNowhere, b->block.end[block] = -kNowhere;
  }
  Shafts4 all;
  set_shaft(*b, 0, padded, 0, &all);
  for (int row = 0; row < 4; ++row)
    b->at_zero[row] = Float4::splat(all.at_zero[row][0]), b->slope[row] = Float4::splat(all.slope[row][0]);
  b->all_begin = Float4::splat(all.begin[0]), b->all_end = Float4::splat(all.end[0]);
}

// The depths that scene and slack leave; the coordinates' greatest gives the slack.
inline void set_slack(const Box& bounds, int padded, Bundle* b, float* scene_begin, float* scene_end) {
  const int axes[] = {b->kx, b->ky, b->kz};
  Float4 reach = Float4::splat(0);
  for (int k = 0; k < 3; ++k) {
    float reference = b->reference[k] = b->origin[k][0];
    float low = bounds.low[axes[k]] - reference, high = bounds.high[axes[k]] - reference;
    reach = max(reach, max(abs(Float4::splat(low)), abs(Float4::splat(high))));
    for (int i = 0; i < padded; i += 4)
      reach = max(reach, abs(Float4::load(b->origin[k] + i) - Float4::splat(reference)));
    *scene_begin = b->sign < 0 ? -high : low, *scene_end = b->sign < 0 ? -low : high;
  }
  b->cubes_are_finite = highest(reach) < 1e12f;
  b->slack = highest(reach) * 0x1p-18f + std::numeric_limits<float>::min();
  *scene_begin -= b->slack, *scene_end += b->slack;
}

// Within (sure_near, sure_far) t neither overflows nor rounds to 0 or to t_max. No denormals there: they take the CPU
// long.
struct CertainDepths {
  Float4 near, far;
};
inline CertainDepths certain_depths(Float4 t_max, Float4 direction_z) {
  Float4 size = abs(direction_z), tiny = Float4::splat(0x1p-80f),
         most = Float4::splat(std::numeric_limits<float>::max());
  Float4 far = min(t_max, most) * size * Float4::splat(1 - 0x1p-20f);
  return {(size + Float4::splat(1)) * tiny, select(tiny <= far, far, Float4::splat(0))};
}

// Fills everything from axes, filter, count, place and the padded origin, direction and t_max, for segments that have
// valid origins and are of one class.
inline void prepare_bundle(const Box& bounds, Bundle* b) {
  int padded = (b->count + 15) & ~15;
  float scene_begin, scene_end;
  set_slack(bounds, padded, b, &scene_begin, &scene_end);
  Float4 zero = Float4::splat(0), sign = Float4::splat(b->sign), slack = Float4::splat(b->slack), origin[3];

  b->open = 0;
  for (int i = 0; i < padded; i += 4) {
    Float4 dz = Float4::load(b->direction[2] + i), t_max = Float4::load(b->t_max + i);
    Float4 shear_x = Float4::load(b->direction[0] + i) / dz, shear_y = Float4::load(b->direction[1] + i) / dz;
    for (int k = 0; k < 3; ++k) origin[k] = Float4::load(b->origin[k] + i) - Float4::splat(b->reference[k]);
    Float4 z = origin[2] * sign, bound = depth_bound(t_max, dz);
    Float4 begin = max(Float4::splat(scene_begin), z - slack), end = min(Float4::splat(scene_end), z + bound + slack);
    Mask4 open = (begin <= end) & (zero < t_max);
    b->open |= static_cast<std::uint64_t>(bits(open)) << i;
    store(b->shear_x + i, shear_x), store(b->shear_y + i, shear_y);
    Float4 slope_x = shear_x * sign, slope_y = shear_y * sign;
    store(b->slope_x + i, slope_x), store(b->slope_y + i, slope_y);
    store(b->x + i, origin[0] - slope_x * z), store(b->y + i, origin[1] - slope_y * z);
    store(b->begin + i, select(open, begin, Float4::splat(kNowhere)));
    store(b->end + i, select(open, end, Float4::splat(-kNowhere)));
    CertainDepths sure = certain_depths(t_max, dz);
    bool back = b->sign < 0;
    store(b->low + i, back ? zero - bound : zero), store(b->high + i, back ? zero : bound);
    store(b->sure_low + i, back ? zero - sure.far : sure.near);
    store(b->sure_high + i, back ? zero - sure.near : sure.far);
  }
  b->sign4 = Float4::splat(b->sign);
  for (int k = 0; k < 3; ++k) b->reference4[k] = Float4::splat(b->reference[k]);
  set_shafts(b);
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
