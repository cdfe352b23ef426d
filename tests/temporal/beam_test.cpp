#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"
#include "support/effort.h"
#include "temporal/triangle_beam.h"

using namespace pocketray;

namespace {

Beam beam_to_point(const Box& from, const Vec3& to) { return {from.low, from.high, to - from.low, to - from.high, 1}; }

Vec3 next_point(Rng* rng, float size) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = size * (2 * next_float(rng) - 1);
  return p;
}

Box next_box(Rng* rng, float size) {
  Vec3 a = next_point(rng, size), b = a + next_point(rng, size * 0.1f);
  return {min(a, b), max(a, b)};
}

Vec3 point_in(Rng* rng, const Box& box) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) * next_float(rng);
  return p;
}

bool meets_box(const Beam& beam, const Box& box) {
  alignas(16) float bounds[6][4];
  for (int lane = 0; lane < 4; ++lane)
    for (int axis = 0; axis < 3; ++axis) bounds[axis][lane] = box.low[axis], bounds[3 + axis][lane] = box.high[axis];
  unsigned met = meets_both(make_box_beam(beam, box), bounds, bounds);
  CHECK((met == 0 || met == 15));
  return met != 0;
}

bool meets_triangle(const Beam& beam, const Vec3 (&corner)[3]) {
  TriangleBlock block;
  Box bounds = empty_box();
  for (int i = 0; i < 3; ++i) bounds = merge(bounds, corner[i]);
  for (int lane = 0; lane < 4; ++lane)
    for (int i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis) block.vertex[i][axis][lane] = corner[i][axis];
  const unsigned met = may_meet(make_beam_hull(bounded_beam(beam, bounds)), block, 15);
  CHECK((met == 0 || met == 15));
  return met != 0;
}

// A random beam, and a place on one of its rays.
struct BeamPlace {
  Beam beam;
  Vec3 place;
};
BeamPlace next_place(Rng* rng, float size) {
  const Vec3 far = next_u32(rng) % 4 ? Vec3{0, 0, 0} : next_point(rng, size * 1000);
  Box from = next_box(rng, size);
  from = {from.low + far, from.high + far};
  const Vec3 origin = point_in(rng, from);
  float t = next_float(rng);
  if (next_u32(rng) % 2) {
    const Vec3 to = next_point(rng, size) + far;
    return {beam_to_point(from, to), origin + (to - origin) * t};
  }
  Box directions = next_box(rng, 1);
  if (next_u32(rng) % 4 == 0) directions.high = directions.low;
  if (next_u32(rng) % 4 == 0) directions.low.x = directions.high.x = 0;
  t *= size * 3;
  return {beam_along(from, directions, next_u32(rng) % 2 ? t : __builtin_inff()),
          origin + point_in(rng, directions) * t};
}

}  // namespace

// Goal: a beam misses no ray in it. Method: random rays of random beams, of all sizes and far from the origin; the box
// of a point on the ray is met.
TEST_CASE("beam_meets_whatever_its_rays_meet") {
  Rng rng = make_rng(7);
  for (int i = 0; i < effort(200000); ++i) {
    const float size = std::ldexp(1.0f, static_cast<int>(next_u32(&rng) % 80) - 40);
    const BeamPlace met = next_place(&rng, size);
    CAPTURE(i);
    REQUIRE(meets_box(met.beam, {met.place, met.place}));
  }
}

// Goal: a beam leaves out what is beside, behind and beyond it.
TEST_CASE("beam_leaves_out_boxes_beside_behind_and_beyond") {
  const Box from = {{-1, -1, 0}, {1, 1, 0}};
  const Beam beam = beam_to_point(from, {0, 0, 10});
  CHECK(meets_box(beam, {{-0.1f, -0.1f, 4}, {0.1f, 0.1f, 5}}));
  CHECK(!meets_box(beam, {{0.9f, 0.9f, 5}, {1, 1, 6}}));  // the beam has narrowed to half its width there
  CHECK(!meets_box(beam, {{-1, -1, -2}, {1, 1, -1}}));
  CHECK(!meets_box(beam, {{-1, -1, 11}, {1, 1, 12}}));
  const Beam wide = beam_along({{0, 0, 0}, {0, 0, 0}}, {{-1, -1, 1}, {1, 1, 1}}, 5);
  CHECK(meets_box(wide, {{2.5f, 2.5f, 3}, {3, 3, 3.5f}}));
  CHECK(!meets_box(wide, {{4, 0, 3}, {5, 0, 3}}));
  CHECK(!meets_box(wide, {{0, 0, 6}, {0, 0, 7}}));
}

// Goal: an empty lane of a node, whose box is inverted, is met by no beam that ends.
TEST_CASE("beam_along_zero_slopes_meets_by_place_alone") {
  const Beam still = beam_along({{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {0, 0, 0}}, 1);
  CHECK(meets_box(still, {{0.5f, 0.5f, 0.5f}, {2, 2, 2}}));
  CHECK(!meets_box(still, {{1.5f, 0.5f, 0.5f}, {2, 2, 2}}));
}

// Goal: a beam misses no triangle that its rays hit. Method: as for boxes, with random triangles around the place, also
// needles and slivers, and with places on their edges and corners.
TEST_CASE("beam_meets_triangles_that_its_rays_hit") {
  Rng rng = make_rng(8);
  for (int i = 0; i < effort(200000); ++i) {
    const float size = std::ldexp(1.0f, static_cast<int>(next_u32(&rng) % 80) - 40);
    const BeamPlace met = next_place(&rng, size);
    const float reach = std::ldexp(size, -static_cast<int>(next_u32(&rng) % 12));
    const Vec3 one = next_point(&rng, reach);
    Vec3 other = next_point(&rng, reach);
    if (next_u32(&rng) % 4 == 0) other = one * next_float(&rng) + other * 0x1p-10f;
    float u = next_float(&rng), v = next_float(&rng) * (1 - u);
    if (next_u32(&rng) % 4 == 0) u = 0;
    if (next_u32(&rng) % 4 == 0) v = 0;
    const Vec3 corner = met.place - one * u - other * v;
    CAPTURE(i);
    REQUIRE(meets_triangle(met.beam, {corner, corner + one, corner + other}));
  }
}

// Goal: a beam that passes a slanting triangle on any side of it leaves it out, although it meets the triangle's box.
// Method: a thin beam around points of the box of a random triangle, on its far side from an edge by a tenth of its
// size.
TEST_CASE("beam_leaves_out_triangles_beside_it") {
  Rng rng = make_rng(9);
  int beside = 0, left_out = 0;
  for (int i = 0; i < effort(20000); ++i) {
    const Vec3 corner[3] = {next_point(&rng, 1), next_point(&rng, 1), next_point(&rng, 1)};
    Vec3 from = next_point(&rng, 1), to = next_point(&rng, 1);
    if (next_u32(&rng) % 2) from = from + (from - to) * 3.0f;  // the beam's ends may be on either side
    const Vec3 room = {0x1p-10f, 0x1p-10f, 0x1p-10f};
    const Beam beam = beam_to_point({from - room, from + room}, to);
    const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const float a = dot(normal, from - corner[0]), b = dot(normal, to - corner[0]), clear = 0.05f * length(normal);
    bool apart = std::fmin(a, b) > clear || std::fmax(a, b) < -clear;
    const Vec3 direction = normalize(to - from);
    for (int k = 0; k < 3 && !apart; ++k) {
      const Vec3 edge = cross(corner[(k + 1) % 3] - corner[k], direction);
      const float inside = dot(edge, corner[(k + 2) % 3] - corner[k]), at = dot(edge, from - corner[k]);
      apart = inside > 0 ? at < -0.05f * length(edge) : at > 0.05f * length(edge);
    }
    beside += apart;
    left_out += apart && !meets_triangle(beam, corner);
  }
  CHECK(beside > effort(20000) / 4);
  CHECK(left_out * 1000 > beside * 999);  // a needle may be too thin beside the beam's width
}
