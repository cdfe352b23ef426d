#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"
#include "support/effort.h"
#include "temporal/box_beam.h"

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
  unsigned met = meets(make_box_beam(beam, box), bounds);
  CHECK((met == 0 || met == 15));
  return met != 0;
}

}  // namespace

// Goal: a beam misses no ray in it. Method: random rays of random beams, of all sizes and far from the origin; the box
// of a point on the ray is met.
TEST_CASE("beam_meets_whatever_its_rays_meet") {
  Rng rng = make_rng(7);
  for (int i = 0; i < effort(200000); ++i) {
    const float size = std::ldexp(1.0f, static_cast<int>(next_u32(&rng) % 80) - 40);
    const Vec3 far = next_u32(&rng) % 4 ? Vec3{0, 0, 0} : next_point(&rng, size * 1000);
    Box from = next_box(&rng, size);
    from = {from.low + far, from.high + far};
    Vec3 origin = point_in(&rng, from), place;
    Beam beam;
    float t = next_float(&rng);
    if (next_u32(&rng) % 2) {
      Vec3 to = next_point(&rng, size) + far;
      beam = beam_to_point(from, to);
      place = origin + (to - origin) * t;
    } else {
      Box directions = next_box(&rng, 1);
      if (next_u32(&rng) % 4 == 0) directions.high = directions.low;
      if (next_u32(&rng) % 4 == 0) directions.low.x = directions.high.x = 0;
      t *= size * 3;
      beam = beam_along(from, directions, next_u32(&rng) % 2 ? t : __builtin_inff());
      place = origin + point_in(&rng, directions) * t;
    }
    CAPTURE(i);
    REQUIRE(meets_box(beam, {place, place}));
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
