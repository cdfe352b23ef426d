#include "base/transform.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "base/rng.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

Vec3 random_vector(Rng* rng) { return {next_float(rng) * 2 - 1, next_float(rng) * 2 - 1, next_float(rng) * 2 - 1}; }

// Random linear part: rotation × scale × shear, mirrored in half of the cases, scales over six decades.
Transform random_transform(Rng* rng) {
  Vec3 axis = normalize(random_vector(rng));
  float half = next_float(rng) * 3;
  Quaternion q = {axis.x * std::sin(half), axis.y * std::sin(half), axis.z * std::sin(half), std::cos(half)};
  auto scale = [&] { return std::pow(10.0f, next_float(rng) * 6 - 3) * (next_u32(rng) & 1 ? 1.0f : -1.0f); };
  Transform shear;
  shear.m[0][1] = next_float(rng) * 4 - 2, shear.m[1][2] = next_float(rng) * 4 - 2;
  Vec3 scales = {scale(), scale(), scale()};
  return compose(random_vector(rng), q, scales) * shear;
}

Vec3d applied(const Transform& t, const Vec3d& v) {
  Vec3d r;
  for (int i = 0; i < 3; ++i)
    r[i] = static_cast<double>(t.m[i][0]) * v.x + static_cast<double>(t.m[i][1]) * v.y +
           static_cast<double>(t.m[i][2]) * v.z;
  return r;
}

}  // namespace

// Goal: HARDCASES row 26: n′·t′ = 0 within 1e-6 and orientation kept under shear, mirroring and non-uniform scale.
// Method: random transforms; the transformed normal must be perpendicular to the images of two tangents that span the
// surface (in double, so that rounding of the float tangents does not count) and agree with the winding, flipped if the
// map mirrors: n′ · (t1′ × t2′) · det > 0.
TEST_CASE("hard_26_normals_stay_perpendicular_and_keep_their_side") {
  count_assertions("perpendicular within 1e-6, side kept");
  Rng rng = make_rng(26);
  for (int i = 0; i < 5000; ++i) {
    CAPTURE(i);
    Transform t = random_transform(&rng);
    Vec3 tangent = random_vector(&rng), bitangent = random_vector(&rng);
    Vec3d a = {tangent.x, tangent.y, tangent.z}, b = {bitangent.x, bitangent.y, bitangent.z};
    Vec3d n = cross(a, b);
    if (length(n) < 0.05) continue;
    Vec3d unit = normalize(n);
    Vec3 n_float = {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)};
    // The float normal is perpendicular to slightly rotated tangents: use those.
    Vec3d nd = {n_float.x, n_float.y, n_float.z};
    a = a - nd * (dot(a, nd) / dot(nd, nd)), b = b - nd * (dot(b, nd) / dot(nd, nd));
    Vec3 normal = transform_normal(t, n_float);
    Vec3d normal_d = {normal.x, normal.y, normal.z};
    Vec3d a_world = applied(t, a), b_world = applied(t, b);
    CHECK(std::fabs(dot(normal_d, normalize(a_world))) <= 1e-6);
    CHECK(std::fabs(dot(normal_d, normalize(b_world))) <= 1e-6);
    CHECK(std::fabs(length(normal_d) - 1) <= 2e-7);
    CHECK(dot(normal_d, cross(a_world, b_world)) * determinant(t) > 0);
  }
}

// Goal: HARDCASES row 27: transforms that cannot be inverted within float range are detected; normals never become NaN.
// Method: determinants 0, 1e-38, infinite, NaN.
TEST_CASE("hard_27_singular_transforms_are_told_apart") {
  count_assertions("told apart");
  Transform t;
  CHECK(is_invertible(t));
  for (float bad :
       {0.0f, 1e-38f, -1e-38f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    CAPTURE(bad);
    t.m[1][1] = bad;
    CHECK(!is_invertible(t));
    CHECK(is_finite(transform_normal(t, {0.6f, 0, 0.8f})));
  }
  for (float good : {1.2e-38f, -1.2e-38f, 3e38f, -1.0f}) {
    t.m[1][1] = good;
    CHECK(is_invertible(t));
  }
  t = Transform();
  t.m[0][0] = 3e38f, t.m[1][1] = 3e38f;  // a determinant that overflows float
  CHECK(!is_invertible(t));
  CHECK(transform_normal(t, {0, 0, 1}) == Vec3{0, 0, 1});
  t = Transform();
  t.m[2][2] = 0;  // flattened onto a plane: only its own normal remains
  CHECK(transform_normal(t, {0, 0, 1}) == Vec3{0, 0, 1});
  CHECK(transform_normal(t, {1, 0, 0}) == Vec3{0, 0, 0});
}

// Goal: a product applies its right factor first, to points, vectors and normals alike.
TEST_CASE("transform_product_is_composition") {
  Rng rng = make_rng(5);
  for (int i = 0; i < 200; ++i) {
    Transform a = random_transform(&rng), b = random_transform(&rng);
    Vec3 p = random_vector(&rng);
    Vec3 once = transform_point(a * b, p), twice = transform_point(a, transform_point(b, p));
    float size = length(abs(twice)) + std::fabs(a.m[0][0]) * 1e3f + 1e3f;
    CHECK(length(once - twice) <= 1e-2f * size);
  }
  Transform shift = compose({1, 2, 3}, Quaternion(), {1, 1, 1}), grow = compose({0, 0, 0}, Quaternion(), {2, 2, 2});
  CHECK(transform_point(shift * grow, {1, 1, 1}) == Vec3{3, 4, 5});
  CHECK(transform_point(grow * shift, {1, 1, 1}) == Vec3{4, 6, 8});
  CHECK(transform_vector(shift * grow, {1, 1, 1}) == Vec3{2, 2, 2});
}

// Goal: quaternions rotate by the right-hand rule [glTF 2.0, sec. 3.5.3]; scale first, then rotation, then translation.
TEST_CASE("compose_scales_then_turns_then_moves") {
  const float h = std::sqrt(0.5f);
  Transform t = compose({10, 0, 0}, {0, 0, h, h}, {2, 3, 4});
  Vec3 p = transform_point(t, {1, 1, 1});
  CHECK(std::fabs(p.x - 7) <= 2e-6f);
  CHECK(std::fabs(p.y - 2) <= 2e-6f);
  CHECK(p.z == 4);
  p = transform_vector(compose({0, 0, 0}, {h, 0, 0, h}, {1, 1, 1}), {0, 1, 0});
  CHECK(std::fabs(p.z - 1) <= 1e-6f);
  p = transform_vector(compose({0, 0, 0}, {0, h, 0, h}, {1, 1, 1}), {0, 0, 1});
  CHECK(std::fabs(p.x - 1) <= 1e-6f);
  CHECK(determinant(compose({1, 2, 3}, {0, 0, h, h}, {2, -3, 4})) == doctest::Approx(-24).epsilon(1e-6));
}
