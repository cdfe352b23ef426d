// The triangle test alone: HARDCASES rows 3, 4, 5, 9, 10 and 62.
#include <doctest/doctest.h>

#include <cmath>

#include "accel/oracle.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

double ulp_of(double x) {
  return std::nextafter(static_cast<float>(x), kInfinity) - static_cast<double>(static_cast<float>(x));
}

Mesh one_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  Mesh mesh;
  add_triangle(&mesh, a, b, c);
  return mesh;
}

// t of the ray at the plane of the triangle, in double.
double plane_t(const Ray& ray, const Mesh& mesh) {
  return oracle_triangle(ray, mesh.positions[0], mesh.positions[1], mesh.positions[2], 0).t;
}

}  // namespace

// Goal: tiny triangles are hit like any other. Method: legs from 2e-4 down to 1e-15, rays at the centroid from
// distances in proportion and, along an axis, from far away; t within 4 ulp of double.
TEST_CASE("hard_03_tiny_triangles_are_hit_with_t_within_4_ulp") {
  for (const AccelInfo* info : kAccelList) {
    Rng rng = make_rng(301);
    int missed = 0, rays = 0, tried = 0, inexact = 0;
    double worst = 0;
    for (float leg = 2e-4f; leg >= 1e-15f; leg *= 0.37f)
      for (int i = 0; i < gate_share(200, 10000); ++i, ++tried) {
        Vec3 a = random_vec3(&rng, leg), b = a + Vec3{leg, 0, leg * next_float(&rng)}, c = a + Vec3{0, leg, -leg};
        Mesh mesh = one_triangle(a, b, c);
        auto world = make_world(mesh, info);
        Vec3 centroid = a * (1.0f / 3) + b * (1.0f / 3) + c * (1.0f / 3), origin = centroid;
        if (i % 2) {
          origin = origin + random_vec3(&rng, leg * 1000);
        } else {
          origin.z = between(&rng, 0.5f, 2.0f);
        }
        Ray ray = {origin, centroid - origin, kInfinity};
        // An oblique ray nearly in the plane may miss the triangle by the rounding of its own direction.
        if (i % 2 && oracle_triangle(ray, a, b, c, 4).verdict != Verdict::hit) continue;
        Hit hit = closest(*world, ray);
        missed += hit.triangle != 0, ++rays;
        if (hit.triangle != 0) continue;
        double error = std::fabs(hit.t - plane_t(ray, mesh)) / ulp_of(hit.t);
        inexact += !(error <= 4);
        worst = std::fmax(worst, error);
      }
    INFO(info->name << ", worst t error " << worst << " ulp");
    CHECK(missed == 0);
    CHECK(inexact == 0);
    CHECK(rays > tried / 1000 * 999);
    count_hard(rays, missed + inexact, "hit, t within 4 ulp");
  }
}

// Goal: triangles without area are never hit, and nothing is written. Method: points and collinear corners at many
// places and sizes; oblique and axis-parallel rays at them.
TEST_CASE("hard_04_pointlike_and_collinear_triangles_are_missed_and_t_is_untouched") {
  for (const AccelInfo* info : kAccelList) {
    Rng rng = make_rng(302);
    int touched = 0;
    for (int i = 0; i < gate_share(20000, 1000000); ++i) {
      float size = std::ldexp(1.0f, static_cast<int>(next_u32(&rng) % 80) - 40);
      Vec3 a = random_vec3(&rng, size), q = random_vec3(&rng, size);
      Mesh mesh = i % 3 == 0   ? one_triangle(a, a, a)
                  : i % 3 == 1 ? one_triangle(a, a + q, a)
                               : one_triangle(q * 0.0f, q, q * (i % 2 ? 2.0f : -0.5f));
      auto world = make_world(mesh, info);
      Vec3 target = i % 3 == 2 ? q * next_float(&rng) : a, origin = target + random_vec3(&rng, size);
      if (i % 4 == 0) origin = {target.x, target.y, target.z + size};
      Hit hit = closest(*world, {origin, target - origin, kInfinity});
      touched += hit.triangle != kNoTriangle || hit.t != -1;
      touched += info->occluded(world->accel, {origin, target - origin, kInfinity}, nullptr, nullptr);
    }
    INFO(info->name);
    CHECK(touched == 0);
    count_hard(gate_share(20000, 1000000), touched, "missed, t untouched");
  }
}

// Goal: slivers of 1:10^6 and rays in their planes get the answer of exact arithmetic outside a band of 4 ulp. Method:
// the double oracle, rays at the sliver, beside it, and in its plane.
TEST_CASE("hard_05_slivers_and_edge_on_rays_are_as_double_says_outside_4_ulp") {
  for (const AccelInfo* info : kAccelList) {
    Rng rng = make_rng(303);
    const int rays = gate_share(30000, 1000000);
    int wrong = 0, decided = 0, hits = 0;
    for (int i = 0; i < rays; ++i) {
      Vec3 a = random_vec3(&rng, 1), q = random_vec3(&rng, 1), r = normalize(cross(q, random_vec3(&rng, 1)));
      Mesh mesh = one_triangle(a, a + q, a + q * 0.4f + r * (length(q) * 1e-6f));
      auto world = make_world(mesh, info);
      Vec3 target = a + q * between(&rng, 0.1f, 0.9f) + r * between(&rng, -2e-6f, 3e-6f);
      Vec3 origin =
          target + (i % 3 == 0 ? q * between(&rng, -2, 2) + r * between(&rng, -1, 1) : random_vec3(&rng, 0.05f));
      Ray ray = {origin, target - origin, kInfinity};
      if (is_zero(ray.direction)) continue;
      Hit hit = closest(*world, ray);
      OracleHit expected = oracle_triangle(ray, mesh.positions[0], mesh.positions[1], mesh.positions[2], 4);
      bool found = hit.triangle != kNoTriangle;
      if (expected.verdict == Verdict::hit && expected.t - expected.t_error > 0) ++decided, ++hits, wrong += !found;
      if (expected.verdict == Verdict::miss) ++decided, wrong += found;
    }
    INFO(info->name << ": " << decided << " decided, " << hits << " hits");
    CHECK(wrong == 0);
    CHECK(decided > rays / 3);
    CHECK(hits > rays / 150);
    count_hard(decided, wrong, "as double says outside 4 ulp");
  }
}

// Goal: invalid rays hit nothing and do no work; extreme but valid ones hit. Method: every combination of NaN,
// infinities and zero in origin and direction; directions of length 1e-40 to 1e38.
TEST_CASE("hard_09_rays_that_are_not_finite_or_have_no_direction_miss_at_no_cost") {
  Mesh mesh = jittered_sphere(3, 1, {0, 0, 0}, 0.05f, 31);
  const float odd[] = {kNan, kInfinity, -kInfinity, 0.0f, -0.0f, 1.0f};
  for (const AccelInfo* info : kAccelList) {
    auto world = make_world(mesh, info);
    int wrong = 0;
    TraceStats stats;
    for (int i = 0; i < 216; ++i) {
      Vec3 v = {odd[i % 6], odd[i / 6 % 6], odd[i / 36]};
      bool finite = is_finite(v);
      if (!finite) wrong += closest(*world, {v, {0, 0, 1}, kInfinity}, &stats).triangle != kNoTriangle;
      if (!finite || is_zero(v)) wrong += closest(*world, {{0, 0, 0}, v, kInfinity}, &stats).triangle != kNoTriangle;
      if (!finite || is_zero(v)) wrong += info->occluded(world->accel, {{0, 0, 0}, v, kInfinity}, nullptr, &stats);
      if (finite && !is_zero(v)) wrong += closest(*world, {{0, 0, 0}, v, kInfinity}).triangle == kNoTriangle;
    }
    for (float t_max : {kNan, 0.0f, -1.0f, -kInfinity})
      wrong += closest(*world, {{0, 0, 0}, {0, 0, 1}, t_max}, &stats).triangle != kNoTriangle;
    INFO(info->name);
    CHECK(wrong == 0);
    if (info != &kBruteAccel) CHECK(stats.nodes + stats.triangles == 0);
    Hit unit = closest(*world, {{0, 0, 0}, {0.25f, 0.5f, 1}, kInfinity});
    for (int exponent : {-126, -100, -60, -30, 30, 60, 100, 125}) {
      float s = std::ldexp(1.0f, exponent);
      Hit hit = closest(*world, {{0, 0, 0}, {0.25f * s, 0.5f * s, s}, kInfinity});
      INFO("direction times 2^" << exponent);
      CHECK(hit.triangle == unit.triangle);
      CHECK(same_bits(hit.u, unit.u));
      CHECK(hit.t == std::ldexp(unit.t, -exponent));
      Hit beyond = closest(*world, {{0, 0, 0}, {0.25f * s, 0.5f * s, s}, hit.t});
      CHECK(beyond.triangle == kNoTriangle);  // t_max is exclusive
    }
    count_hard(2 * 216 + 4 + 2 * 8, wrong, "missed without a step");
  }
}

// Goal: exact t, u and v for a well-shaped triangle, including its edges and corners. Method: the unit triangle, exact
// rays from a grid of points and directions that are sums of powers of two; the results are known without rounding.
TEST_CASE("hard_10_unit_triangle_gives_t_u_v_within_16_ulp_edges_included") {
  const float slopes[] = {-0.75f, -0.25f, 0, 0.5f, 1};
  auto unit_ulps = [](float x, double expected) { return std::fabs(x - expected) / kFloatUlp; };
  for (const AccelInfo* info : kAccelList) {
    auto world = make_world(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), info);
    int missed = 0, inexact = 0, rays = 0;
    double worst = 0;
    for (int i = 0; i <= 16; ++i)
      for (int j = 0; i + j <= 16; ++j)
        for (float sx : slopes)
          for (float sy : slopes)
            for (float side : {-4.0f, 1.0f}) {
              Vec3 p = {i / 16.0f, j / 16.0f, 0}, d = {sx, sy, -side}, o = p - d * 2.0f;
              Hit hit = closest(*world, {o, d, kInfinity});
              missed += hit.triangle != 0;
              double error = std::fmax(std::fmax(unit_ulps(hit.u, p.x), unit_ulps(hit.v, p.y)), unit_ulps(hit.t, 2));
              worst = std::fmax(worst, error);
              inexact += !(error <= 16), ++rays;
            }
    INFO(info->name << ", worst " << worst << " ulp of 1");
    CHECK(missed == 0);
    CHECK(inexact == 0);
    count_hard(rays, missed + inexact, "t, u, v within 16 ulp");
  }
}

// Goal: float and double choose the same triangle outside a band of 4 ulp. Method: soup of all sizes and positions,
// random rays; the oracle decides nearly all of them.
TEST_CASE("hard_62_float_ids_are_those_of_double_outside_a_band_of_4_ulp") {
  for (const Mesh& mesh : generated_meshes()) {
    if (mesh.triangles.size() > 700 || mesh.name == "denormal") continue;  // ulps are meaningless there
    auto world = make_world(mesh, &kBvhAccel);
    Rng rng = make_rng(304);
    float size = mesh.triangles.empty() ? 1.0f : max_component(extent(world->accel.bounds));
    int wrong = 0, decided = 0, rays = gate_share(1000, 20000);
    for (int i = 0; i < rays; ++i) {
      Vec3 origin = random_vec3(&rng, size), direction = random_vec3(&rng, 1);
      Ray ray = {origin, direction, kInfinity};
      wrong += !oracle_agrees(*world, ray, closest(*world, ray), 4, &decided);
    }
    INFO(mesh.name << ": " << decided << " decided");
    CHECK(wrong == 0);
    CHECK(decided > rays / 5 * 4);
    count_hard(decided, wrong, "the id of double outside 4 ulp");
  }
}
