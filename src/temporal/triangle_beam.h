// Beams against triangles, four at a time: a plane between them proves that no ray of the beam meets the triangle.
#pragma once
#include <algorithm>

#include "accel/triangle.h"
#include "temporal/box_beam.h"

namespace pocketray {

// The part of a beam within given bounds, as the hull of two boxes, for tests against triangles there.
struct BeamHull {
  float low[2][3], high[2][3];  // boxes at its start and at its end
  float direction[3];           // from one to the other; the largest component is ±1
  float scale;                  // makes the largest coordinate about 1
  bool is_bounded;              // otherwise nothing can be proved
};

// Products of three coordinates between these are, with their errors, far from the smallest and the largest
// floats.
constexpr float kTameMin = 0x1p-40f, kTameMax = 0x1p40f;

// Where all of the beam has left the bounds.
inline float leaves_at(const BoxBeam& b, const Box& bounds) {
  float t = b.t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const float limit[2] = {bounds.high[axis] - b.low[axis], b.high[axis] - bounds.low[axis]};
    for (int side = 0; side < 2; ++side)
      if (b.sign[2 * axis + side] > 0) t = std::min(t, limit[side] * b.inverse[2 * axis + side]);
  }
  return std::max(t, 0.0f) * (1 + 0x1p-20f);
}

// A beam, its form for tests against boxes, and the bounds of these boxes.
struct BoundedBeam {
  Beam beam;
  BoxBeam tested;
  Box bounds;
  bool is_tame;  // far enough from the smallest and the largest floats that flushed denormals affect no test
};

inline BoundedBeam bounded_beam(const Beam& beam, const Box& bounds) {
  const float size = max_component(max(max(abs(beam.low), abs(beam.high)), max(abs(bounds.low), abs(bounds.high)))),
              slope = max_component(max(abs(beam.low_slope), abs(beam.high_slope)));
  return {beam, make_box_beam(beam, bounds), bounds, size > kTameMin && size < kTameMax && slope < kTameMax};
}

inline BeamHull make_beam_hull(const BoundedBeam& b) {
  BeamHull hull;
  const Beam& beam = b.beam;
  const float t = leaves_at(b.tested, b.bounds);
  const Vec3 low = beam.low + beam.low_slope * t, high = beam.high + beam.high_slope * t;
  Vec3 size = max(max(abs(beam.low), abs(beam.high)), max(abs(b.bounds.low), abs(b.bounds.high)));
  size = max(size, max(abs(low), abs(high)));
  const float most = max_component(size);
  hull.is_bounded = most > kTameMin && most < kTameMax && t < __builtin_inff();
  if (!hull.is_bounded) return hull;
  hull.scale = 1 / most;
  float longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    // Far above all roundings here and in the rays (make_box_beam()).
    const float slack = size[axis] * 0x1p-15f + most * 0x1p-19f;
    hull.low[0][axis] = beam.low[axis] - slack, hull.high[0][axis] = beam.high[axis] + slack;
    hull.low[1][axis] = low[axis] - slack, hull.high[1][axis] = high[axis] + slack;
    hull.direction[axis] = (low[axis] + high[axis]) - (beam.low[axis] + beam.high[axis]);
    longest = std::max(longest, std::fabs(hull.direction[axis]));
  }
  if (longest > 0)
    for (float& component : hull.direction) component /= longest;
  return hull;
}

inline namespace POCKETRAY_ISA {

struct Points4 {
  Float4 at[3];
};

inline Points4 cross(const Points4& a, const Points4& b) {
  return {{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
           a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}
inline Float4 dot(const Points4& a, const Points4& b) {
  return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}

// Returns whether a plane with this normal, however rounded, separates the hull from the triangle.
inline Mask4 are_apart_along(const BeamHull& hull, const Points4& normal, const Points4 (&corner)[3]) {
  Float4 low[2], high[2];
  for (int end = 0; end < 2; ++end) {
    for (int axis = 0; axis < 3; ++axis) {
      const Float4 one = normal.at[axis] * Float4::splat(hull.low[end][axis]),
                   other = normal.at[axis] * Float4::splat(hull.high[end][axis]);
      low[end] = axis == 0 ? min(one, other) : low[end] + min(one, other);
      high[end] = axis == 0 ? max(one, other) : high[end] + max(one, other);
    }
  }
  const Float4 a = dot(normal, corner[0]), b = dot(normal, corner[1]), c = dot(normal, corner[2]);
  const Float4 flushed = Float4::splat(0x1p-100f);  // more than flushed denormals add up to
  return (max(max(a, b), c) + flushed < min(low[0], low[1])) | (max(high[0], high[1]) + flushed < min(min(a, b), c));
}

// Mask of the triangles `among` that a ray of the beam may meet.
inline unsigned may_meet(const BeamHull& hull, const TriangleBlock& block, unsigned among) {
  if (!hull.is_bounded) return among;
  Points4 corner[3], edge[3];
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis) corner[i].at[axis] = Float4::load(block.vertex[i][axis]);
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis)
      edge[i].at[axis] = (corner[(i + 1) % 3].at[axis] - corner[i].at[axis]) * Float4::splat(hull.scale);
  among &= ~bits(are_apart_along(hull, cross(edge[0], edge[1]), corner));
  const Points4 direction = {
      {Float4::splat(hull.direction[0]), Float4::splat(hull.direction[1]), Float4::splat(hull.direction[2])}};
  for (int i = 0; i < 3 && among; ++i) among &= ~bits(are_apart_along(hull, cross(edge[i], direction), corner));
  return among;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
