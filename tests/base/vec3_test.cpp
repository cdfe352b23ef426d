#include "base/vec3.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "base/box.h"
#include "base/rng.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

Vec3d widen(const Vec3& v) { return {v.x, v.y, v.z}; }

Vec3 random_vector(Rng* rng) { return {next_float(rng) - 0.5f, next_float(rng) - 0.5f, next_float(rng) - 0.5f}; }

}  // namespace

// Goal: HARDCASES row 30: normals of every size become unit, zero and non-finite ones become zero, nothing becomes NaN.
// Method: random directions scaled by all powers of two from denormal to the largest; compared in double.
TEST_CASE("hard_30_normalize_takes_every_magnitude") {
  count_assertions("unit within 2e-7, or zero");
  Rng rng = make_rng(30);
  for (int exponent = -120; exponent <= 126; ++exponent) {
    CAPTURE(exponent);
    for (int i = 0; i < 20; ++i) {
      Vec3 v = random_vector(&rng);
      Vec3 scaled = {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
      Vec3 unit = normalize(scaled);
      CHECK(std::fabs(length(widen(unit)) - 1) <= 2e-7);
      CHECK(length(cross(widen(unit), normalize(widen(scaled)))) <= 2e-7);
      if (exponent > -100) CHECK(unit == normalize(v));  // scaling by a power of two changes no bit
    }
  }
  for (float size : {1e30f, 1e-30f, 3e38f, 1e-45f}) {
    CHECK(normalize(Vec3{size, 0, 0}) == Vec3{1, 0, 0});
    CHECK(normalize(Vec3{0, -size, 0}) == Vec3{0, -1, 0});
  }
  for (const Vec3& bad : {Vec3{0, 0, 0}, Vec3{-0.0f, 0, 0}, Vec3{kNan, 1, 1}, Vec3{1, kNan, 1}, Vec3{1, 1, kNan},
                          Vec3{kInf, 0, 0}, Vec3{1, -kInf, kNan}})
    CHECK(is_zero(normalize(bad)));
}

// Goal: an orthonormal basis for every unit vector, including the poles and ±0 [Duff et al. 2017].
TEST_CASE("make_basis_is_orthonormal_everywhere") {
  Rng rng = make_rng(31);
  for (int i = 0; i < 1000; ++i) {
    Vec3 n = normalize(random_vector(&rng));
    if (i == 0) n = {0, 0, 1};
    if (i == 1) n = {0, 0, -1};
    if (i == 2) n = {1, 0, -0.0f};
    if (i == 3) n = normalize(Vec3{1e-4f, 0, -1});
    Vec3 t, b;
    make_basis(n, &t, &b);
    CHECK(std::fabs(dot(t, b)) <= 1e-6f);
    CHECK(std::fabs(dot(t, n)) <= 1e-6f);
    CHECK(std::fabs(length(t) - 1) <= 1e-6f);
    CHECK(dot(cross(t, b), n) >= 1 - 1e-6f);  // right-handed
  }
}

TEST_CASE("vec3_products_obey_their_identities") {
  CHECK(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}) == Vec3{0, 0, 1});
  CHECK(dot(Vec3{1, 2, 3}, Vec3{4, -5, 6}) == 12);
  CHECK(length(Vec3{2, 3, 6}) == 7);
  CHECK(max_component(Vec3{1, 9, 3}) == 9);
  CHECK(max_component(Vec3{-1, -9, -3}) == -1);
  CHECK(abs(Vec3{-1, 2, -3}) == Vec3{1, 2, 3});
  Vec3 v = {1, 2, 3};
  v[1] = 5, v *= Vec3{2, 2, 2}, v += Vec3{0, 0, 1};
  CHECK(v == Vec3{2, 10, 7});
  CHECK(!is_finite(Vec3{1, kInf, 1}));
  CHECK(!is_finite(Vec3{kNan, 1, 1}));
}

TEST_CASE("box_merges_and_measures") {
  Box box = empty_box();
  CHECK(is_empty(box));
  CHECK(half_area(box) == 0);
  box = merge(merge(box, Vec3{1, 2, 3}), Vec3{3, 1, 7});
  CHECK(!is_empty(box));
  CHECK(extent(box) == Vec3{2, 1, 4});
  CHECK(center(box) == Vec3{2, 1.5f, 5});
  CHECK(half_area(box) == 2 * 1 + 1 * 4 + 4 * 2);
  CHECK(contains(merge(box, empty_box()), box));
  CHECK(!contains(box, merge(box, Vec3{0, 0, 0})));
  CHECK(half_area(merge(empty_box(), Vec3{5, 5, 5})) == 0);  // a point
  CHECK(is_finite(center(Box{{-3e38f, -3e38f, -3e38f}, {3e38f, 3e38f, 3e38f}})));
}
