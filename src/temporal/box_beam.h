// Beams against the boxes of BVH nodes, four at a time.
#pragma once
#include <cmath>

#include "base/simd.h"
#include "temporal/beam.h"

namespace pocketray {

// A beam prepared for tests against boxes within given bounds.
struct BoxBeam {
  // The beam's planes, low and high of each axis: slope·t ≤ limit of a box, written as t ≤ or ≥ limit · inverse
  // depending on the slope's sign, or, for slope 0, 0 ≤ limit.
  float low[3], high[3], inverse[6];
  int sign[6];
  float t_max;
};

inline BoxBeam make_box_beam(const Beam& beam, const Box& bounds) {
  BoxBeam b;
  b.t_max = beam.t_max;
  // Roundings of t, of slopes and of the rays themselves stay below 2^-21 of the coordinates along an axis; triangles
  // are hit by rays that miss them by up to 6 · 2^-24 of the largest extent along any (box_ray.h). These cover both.
  const Vec3 size = max(max(abs(beam.low), abs(beam.high)), max(abs(bounds.low), abs(bounds.high)));
  const float most = max_component(size) * 0x1p-19f;
  for (int axis = 0; axis < 3; ++axis) {
    const float slack = size[axis] * 0x1p-15f + most;
    b.low[axis] = beam.low[axis] - slack, b.high[axis] = beam.high[axis] + slack;
    const float slope[2] = {beam.low_slope[axis], -beam.high_slope[axis]};
    for (int side = 0; side < 2; ++side) {
      b.sign[2 * axis + side] = slope[side] > 0 ? 1 : slope[side] < 0 ? -1 : 0;
      b.inverse[2 * axis + side] = slope[side] != 0 ? 1 / slope[side] : 0;
    }
  }
  return b;
}

inline namespace POCKETRAY_ISA {

// Mask of the four pairs of boxes whose common bounds a ray of the beam can meet: there must be a t at which the beam's
// box overlaps them. These are six linear inequalities, so no ray that meets a box is missed. (If a product is not a
// number, the bound stays.)
inline unsigned meets_both(const BoxBeam& b, const float (&one)[6][4], const float (&other)[6][4]) {
  Float4 begin = Float4::splat(0), end = Float4::splat(b.t_max), zero = begin;
  Mask4 inside = zero <= zero;
  for (int axis = 0; axis < 3; ++axis) {
    const Float4 low = min(Float4::load(one[axis]), Float4::load(other[axis])),
                 high = max(Float4::load(one[3 + axis]), Float4::load(other[3 + axis]));
    const Float4 limit[2] = {high - Float4::splat(b.low[axis]), Float4::splat(b.high[axis]) - low};
    for (int side = 0; side < 2; ++side) {
      const int sign = b.sign[2 * axis + side];
      const Float4 t = limit[side] * Float4::splat(b.inverse[2 * axis + side]);
      if (sign > 0)
        end = min(t, end);
      else if (sign < 0)
        begin = max(t, begin);
      else
        inside = inside & (zero <= limit[side]);
    }
  }
  return bits(inside & (begin * Float4::splat(1 - 0x1p-20f) <= end));
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
