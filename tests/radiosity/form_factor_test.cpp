// Form factors with known answers: HARDCASES rows 43 to 48.
#include "desktop/radiosity/form_factor.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "base/rng.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr double kParallel = .1998248956, kPerpendicular = .2000437760;

// A unit square over (x, y) = (0, 0) … (1, 1) at height z that faces up or down.
Polygon square(double z, bool up) {
  Polygon p = {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}};
  if (!up) p = {p[3], p[2], p[1], p[0]};
  return p;
}
// The wall x = 0 that faces +x.
const Polygon kWall = {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};

double at_point(const Vec3d& point, const Polygon& polygon) { return point_form_factor(point, {0, 0, 1}, polygon); }

}  // namespace

// Goal: squares that face each other or share an edge have the factors of the closed forms, and those of a closed cube
// add up to 1. Touching squares (row 46) are the hardest case for sampling.
TEST_CASE("hard_43_46_squares_have_their_closed_forms") {
  const double parallel = polygon_form_factor(square(0, true), square(1, false));
  const double perpendicular = polygon_form_factor(square(0, true), kWall);
  CHECK(std::fabs(parallel - kParallel) < 1e-6);
  CHECK(std::fabs(perpendicular - kPerpendicular) < 1e-6);
  CHECK(std::fabs(parallel + 4 * perpendicular - 1) < 1e-6);
  count_assertions("1e-6");
}

// Goal: a light seen from points has the factors of row 37; so has one that the horizon cuts.
TEST_CASE("hard_37_38_point_form_factor_is_exact_and_clipped") {
  const Polygon light = square(1, false);
  CHECK(std::fabs(at_point({.5, .5, 0}, light) - .2394565) < 1e-6);
  CHECK(std::fabs(at_point({0, 0, 0}, light) - .1385316) < 1e-6);
  CHECK(at_point({.5, .5, 2}, light) == 0);              // behind it
  CHECK(at_point({.5, .5, -1}, square(-2, true)) == 0);  // below the horizon
  double last = 1;
  for (int i = 0; i <= 100; ++i) {  // a wall sinks below the horizon: continuous, falling, never negative
    const double z = -i / 100.0;
    const double f = at_point({.3, .5, 0}, {{0, 0, z}, {0, 1, z}, {0, 1, z + 1}, {0, 0, z + 1}});
    CHECK((f >= 0 && f <= last && last - f < (i ? .03 : 1)));
    last = f;
  }
  CHECK(last < 1e-12);
  count_assertions("1e-6");
}

// Goal: distant squares lose no digits. Method: against 1/(π d²) with its next term, which is exact to 2e-6 there.
TEST_CASE("hard_44_distant_squares_keep_their_digits") {
  for (double d : {30.0, 100.0}) {
    const double f = polygon_form_factor(square(0, true), square(d, false));
    const double known = (1 - 2 / (3 * d * d)) / (kPi * d * d);
    CHECK(std::fabs(f / known - 1) < 2e-6);
    CHECK(std::fabs(at_point({.5, .5, 0}, square(d, false)) * kPi * d * d - 1) < 1 / (d * d));
  }
  CHECK(std::fabs(polygon_form_factor(square(0, true), square(30, false)) - 3.534e-4) < 5e-8);
  count_assertions("2e-6 relative");
}

TEST_CASE("hard_45_coaxial_disks") {
  CHECK(std::fabs(coaxial_disk_form_factor(1, 1, 1) - .381966) < 1e-6);
  CHECK(std::fabs(coaxial_disk_form_factor(1, 1, 1e6) * 1e12 - 1) < 1e-6);
  CHECK(coaxial_disk_form_factor(1, 1, 0) == doctest::Approx(1));
  count_assertions("1e-6");
}

// Goal: patches inside a sphere of radius R see Aⱼ/4πR² of each other, whichever they are. Method: small triangles at
// random places.
TEST_CASE("hard_47_patches_inside_a_sphere") {
  Rng rng = make_rng(47);
  auto patch = [&] {
    Vec3d n = {next_float(&rng) - 0.5, next_float(&rng) - 0.5, next_float(&rng) - 0.5};
    n = normalize(n);
    Vec3d s = normalize(cross(n, Vec3d{.3, .5, -.7})), t = cross(n, s);
    Polygon p;
    for (int i = 0; i < 3; ++i)  // counter-clockwise seen from the centre
      p.push_back(normalize(n + s * (.005 * det_cos(-2.1 * i)) + t * (.005 * det_sin(-2.1 * i))) * 2.0);
    return p;
  };
  std::uint64_t wrong = 0;
  const int pairs = gate_share(50, 1000);
  for (int i = 0; i < pairs; ++i) {
    const Polygon a = patch(), b = patch();
    const double known = polygon_area(b) / (4 * kPi * 4);
    if (length(a[0] - b[0]) < 1) continue;
    wrong += !(std::fabs(polygon_form_factor(a, b) / known - 1) < 2e-4);
  }
  CHECK(wrong == 0);
  count_hard(static_cast<std::uint64_t>(pairs), wrong, "2e-4 of the factor, due to flat patches");
}

// Goal: Aᵢ·Fᵢⱼ = Aⱼ·Fⱼᵢ for any two polygons that face each other; a polygon sees nothing of its own plane.
TEST_CASE("hard_48_reciprocity_coplanar_and_self") {
  Rng rng = make_rng(48);
  for (int i = 0; i < 50; ++i) {
    auto jitter = [&] { return static_cast<double>(next_float(&rng)) * .5; };
    const Polygon floor = {{-jitter(), -jitter(), 0}, {1 + jitter(), 0, 0}, {1, 1 + jitter(), 0}};
    const double x = jitter() * 6;
    const Polygon roof = {{x, 1, 1 + jitter()}, {x + 1, 1, 1.5}, {x + 1, 0, 1.5}};
    const double there = polygon_area(floor) * polygon_form_factor(floor, roof),
                 back = polygon_area(roof) * polygon_form_factor(roof, floor);
    CHECK(std::fabs(there - back) < 1e-6 * there);
  }
  Polygon aside = square(0, true);
  for (Vec3d& p : aside) p.x += 2;
  CHECK(polygon_form_factor(square(0, true), aside) < 1e-9);
  CHECK(at_point({.3, .4, 0}, square(0, false)) == 0);
  CHECK(at_point({2, 2, 0}, square(0, true)) == 0);
  count_assertions("1e-6");
}
