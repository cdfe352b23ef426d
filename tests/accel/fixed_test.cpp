// The fixed-point tests of accel/fixed_*.h decide as floats do, or leave the decision to them.
#include <doctest/doctest.h>

#include <cmath>

#include "accel/accel_world.h"
#include "accel/fixed_bundle.h"
#include "base/rng.h"
#include "base/soft_float.h"

using namespace pocketray;

namespace {

// Cases of a test; software floats take their time.
#if defined(POCKETRAY_HAS_NO_FPU)
constexpr int kCases = 200000;
#else
constexpr int kCases = 1000000;
#endif

constexpr float kInf = std::numeric_limits<float>::infinity();

double unit_of(int exponent) { return std::ldexp(1.0, exponent - 126 - 28); }

std::uint32_t next_below(Rng* rng, std::uint32_t count) { return next_u32(rng) % count; }

// A coordinate within ±scale, often with few bits, so that rays and vertices coincide.
float coordinate(Rng* rng, float scale) {
  float x = next_float(rng) * 2 - 1;
  switch (next_below(rng, 4)) {
    case 0:
      return std::floor(x * 4) / 4 * scale;
    case 1:
      return x * 0x1p-12f * scale;
    default:
      return x * scale;
  }
}
Vec3 point(Rng* rng, float scale) { return {coordinate(rng, scale), coordinate(rng, scale), coordinate(rng, scale)}; }

// A ray near a triangle: through a point of it, of an edge or a vertex, or close by, from near or far, before or
// behind.
struct Case {
  Vec3 corner[3];
  Ray ray;
};
Case random_case(Rng* rng, float scale) {
  Case c;
  constexpr float kSizes[] = {1, 0x1p-9f, 0x1p-12f};
  float size = scale * kSizes[next_below(rng, 3)];
  Vec3 middle = point(rng, scale - size);
  for (Vec3& corner : c.corner) corner = middle + point(rng, size);
  if (next_below(rng, 8) == 0) c.corner[2] = c.corner[0] * 0.5f + c.corner[1] * 0.5f;  // a sliver
  float u = next_float(rng), v = next_float(rng) * (1 - u);
  if (next_below(rng, 4) == 0) v = 0;
  if (next_below(rng, 8) == 0) u = 1, v = 0;
  if (next_below(rng, 4) == 0) u += next_float(rng) - 0.5f;
  Vec3 target = c.corner[0] * (1 - u - v) + c.corner[1] * u + c.corner[2] * v;
  Vec3 direction = point(rng, 1);
  float distance = scale * (next_below(rng, 2) ? 1.0f : std::ldexp(1.0f, -static_cast<int>(next_below(rng, 26))));
  c.ray.direction = direction;
  c.ray.origin = target - direction * (next_below(rng, 2) ? distance : -distance);
  c.ray.t_max = next_below(rng, 2) ? kInf : scale * next_float(rng);
  return c;
}

struct Prepared {
  FixedFrame frame;
  ExactRay exact;
  FixedRay ray;
  FixedTriangle triangle;
  TriangleBlock block;
};
// False if the ray hits nothing.
bool prepare(const Case& c, Prepared* p) {
  int of_class = fixed_class(c.ray.direction);
  if (of_class < 0) return false;
  int exponent = greatest_exponent(c.ray.origin);
  for (const Vec3& corner : c.corner) exponent = std::max(exponent, greatest_exponent(corner));
  if (exponent < kFixedExponentMin) return false;
  p->frame = fixed_frame(of_class, exponent);
  make_exact_ray(c.ray, p->frame.axes, &p->exact);
  p->ray = fixed_ray(p->exact, p->frame);
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis)
      for (float& lane : p->block.vertex[i][axis]) lane = c.corner[i][axis];
  p->triangle = fixed_triangle(p->block, 0, p->frame);
  return true;
}

}  // namespace

// Goal: conversion cuts towards zero, over all exponents. Method: compare with double arithmetic.
TEST_CASE("fixed_point_cuts_towards_zero") {
  Rng rng = make_rng(501);
  for (int i = 0; i < 200000; ++i) {
    int exponent = kFixedExponentMin + static_cast<int>(next_below(&rng, 254 - kFixedExponentMin));
    float value = std::ldexp(next_float(&rng) * 2 - 1, exponent - 126 - static_cast<int>(next_below(&rng, 40)));
    double expected = std::trunc(value / unit_of(exponent));
    REQUIRE(to_fixed(value, exponent) == expected);
    float fraction = std::ldexp(next_float(&rng) * 2 - 1, -static_cast<int>(next_below(&rng, 40)));
    REQUIRE(to_fraction(fraction) == std::trunc(fraction * 0x1p31));
    std::int32_t a = static_cast<std::int32_t>(next_u32(&rng)) >> 1, b = to_fraction(fraction);
    double low = a * 0x1p-31 * b - part(a, b);
    REQUIRE(low >= 0);
    REQUIRE(low < 2);
  }
  CHECK(to_fixed(0.0f, 127) == 0);
  CHECK(to_fixed(std::numeric_limits<float>::denorm_min(), kFixedExponentMin) == 0);
  CHECK(to_fixed(1.0f, 126) == 1 << 28);
  CHECK(to_fixed(4.0f, 126) == kFixedMax);
  CHECK(to_fixed(-kInf, 126) == -kFixedMax);
  CHECK(to_fraction(1.0f) == 0x7FFFFFFF);
  CHECK(to_fraction(-1.0f) == -0x7FFFFFFF);
  CHECK(magnitude(std::numeric_limits<std::int32_t>::min()) == 1u << 31);
  CHECK(greatest_exponent({-4, 1, 3.9f}) == 129);
}

// Goal: where integers decide, cross_triangle() agrees; where a triangle is surely behind, t < 0; surely within the
// depths, t is in (0, t_max). Method: random rays through, beside and on the edges of random triangles of all sizes, at
// scales up to the largest; each decision must also be frequent.
TEST_CASE("fixed_triangles_decide_as_floats") {
  const int count = kCases;
  for (float scale : {1.0f, 0x1p-50f, 1000.0f, kCoordinateMax}) {
    INFO("scale " << scale);
    Rng rng = make_rng(502);
    int missed = 0, crossed = 0, doubtful = 0, sure = 0, outside = 0, inside = 0, before = 0, wrong = 0;
    for (int i = 0; i < count; ++i) {
      Case c = random_case(&rng, scale);
      Prepared p;
      if (!prepare(c, &p)) continue;
      const FixedTriangle& v = p.triangle;
      FixedRow z = depth_row(p.ray, v);
      bool positive = false;
      FixedVerdict verdict = cross_fixed(p.ray, v, z, &positive);
      ShearedRay sheared;
      Crossing crossing;
      bool valid = make_sheared_ray(c.ray, &sheared);
      bool crosses = valid && cross_triangle(sheared, c.corner[0], c.corner[1], c.corner[2], &crossing);
      bool hits = crosses && crossing.t > 0 && crossing.t < c.ray.t_max;
      before += hits;
      const std::int32_t limit = depth_limit(c.ray.t_max, p.exact.direction[2], p.frame.exponent);
      if (z.high < -4 || z.low > limit) wrong += hits;
      if (verdict == FixedVerdict::missed) ++missed, wrong += crosses;
      if (verdict == FixedVerdict::doubtful) ++doubtful;
      if (verdict != FixedVerdict::crossed) continue;
      ++crossed, wrong += !crosses;
      FixedDepths depths = fixed_sure_depths(c.ray.t_max, p.exact.direction[2], p.frame.exponent);
      if (depths.low <= z.low && z.high <= depths.high) ++sure, wrong += !hits;
      FixedPlane plane;
      if (!fixed_plane(p.ray, v, z, positive, &plane)) continue;
      if (surely_outside(plane, p.ray, z, limit)) ++outside, wrong += hits;
      if (surely_inside(plane, p.ray, z, depths)) ++inside, wrong += !hits;
    }
    CHECK(wrong == 0);
    CHECK(missed > count / 16);
    CHECK(crossed > count / 8);
    CHECK(doubtful > count / 100);
    CHECK(doubtful < count / 2);
    CHECK(sure > count / 50);
    CHECK(outside > count / 10);
    CHECK(inside > count / 10);
    CHECK(before > count / 10);
  }
}

// Goal: the box of a triangle is never missed by a ray that hits the triangle, and begins before the hit; most other
// boxes are missed. Method: as above, with the triangle's bounds as the box of one child.
TEST_CASE("fixed_boxes_hide_no_hit") {
  const int count = kCases;
  Rng rng = make_rng(503);
  int hit_count = 0, missed = 0, wrong = 0;
  for (int i = 0; i < count; ++i) {
    Case c = random_case(&rng, 1);
    if (next_below(&rng, 2)) c.ray.direction = point(&rng, 1);
    Prepared p;
    ShearedRay sheared;
    if (!prepare(c, &p) || !make_sheared_ray(c.ray, &sheared)) continue;
    Box box = empty_box();
    for (const Vec3& corner : c.corner) box = merge(box, corner);
    BvhNode node = {};
    for (int lane = 0; lane < 4; ++lane) node.child[lane] = kNoChild, set_child_box(&node, lane, no_child_box());
    node.child[0] = 1;
    set_child_box(&node, 0, box);
    FixedBox kept;
    Crossing crossing;
    bool hits = cross_triangle(sheared, c.corner[0], c.corner[1], c.corner[2], &crossing) && crossing.t > 0 &&
                crossing.t < c.ray.t_max;
    float t = hits ? crossing.t : c.ray.t_max;  // as the best hit so far
    std::int32_t near, limit = depth_limit(t, p.exact.direction[2], p.frame.exponent);
    bool miss = misses(p.ray, ChildSlabs{node, 0, p.frame, &kept}, limit, &near);
    hit_count += hits, missed += miss, wrong += hits && (miss || near > limit);
  }
  CHECK(wrong == 0);
  CHECK(hit_count > count / 20);
  CHECK(missed > count / 4);
}

// Goal: the hull of some rays misses no box with a triangle that one of them hits, and begins before the hit; it misses
// most other boxes. Method: rays of a class from near points to near points, or from and to anywhere, against triangles
// around a point of one of them.
TEST_CASE("fixed_hulls_hide_no_hit") {
  Rng rng = make_rng(504);
  int hit_count = 0, missed = 0, wrong = 0, count = 0;
  for (int k = 0; k < 20000; ++k) {
    float from_size = next_below(&rng, 2) ? 1.0f : 0x1p-6f, to_size = next_below(&rng, 2) ? 1.0f : 0x1p-6f;
    Vec3 from = point(&rng, 1), to = point(&rng, 1);
    FixedBundle b;
    Ray rays[kPacketMax];
    std::int32_t limits[kPacketMax];
    int of_class = -1, ray_count = 1 + static_cast<int>(next_below(&rng, 24));
    for (int i = 0; i < ray_count; ++i) {
      Ray ray = {from + point(&rng, from_size), {}, next_below(&rng, 4) ? 1.0f : kInf};
      ray.direction = to + point(&rng, to_size) - ray.origin;
      int its_class = fixed_class(ray.direction);
      if (its_class < 0 || (b.count > 0 && its_class != of_class)) continue;
      if (b.count == 0) of_class = its_class, b.frame = fixed_frame(of_class, 126 + 3);
      rays[b.count] = ray;
      add_ray(&b, ray, 0);
      limits[b.count - 1] = depth_limit(ray.t_max, b.ray[b.count - 1].exact.direction[2], b.frame.exponent);
    }
    if (b.count == 0) continue;
    set_hulls(&b, limits);
    for (int n = 0; n < 8; ++n) {
      const int aimed = static_cast<int>(next_below(&rng, static_cast<std::uint32_t>(b.count)));
      Vec3 middle = rays[aimed].origin + rays[aimed].direction * (next_float(&rng) * 1.25f), corner[3];
      Box box = empty_box();
      float size = next_below(&rng, 2) ? 0.5f : 0x1p-7f, aside = next_below(&rng, 2) ? 0 : 0.5f;
      for (Vec3& at : corner) at = middle + point(&rng, size) + Vec3{aside, aside, aside}, box = merge(box, at);
      BvhNode node = {};
      set_child_box(&node, 0, box);
      FixedBox kept;
      const ChildSlabs slabs = {node, 0, b.frame, &kept};
      slabs.z(), slabs.x(), slabs.y();
      std::int32_t near;
      bool miss = misses(b.all, slabs, b.all.length, &near);
      ++count, missed += miss;
      for (int i = 0; i < b.count; ++i) {
        ShearedRay sheared;
        Crossing crossing;
        if (!make_sheared_ray(rays[i], &sheared)) continue;
        if (!cross_triangle(sheared, corner[0], corner[1], corner[2], &crossing)) continue;
        if (!(crossing.t > 0 && crossing.t < rays[i].t_max)) continue;
        const std::int32_t limit = depth_limit(crossing.t, b.ray[i].exact.direction[2], b.frame.exponent);
        ++hit_count, wrong += miss || near > limit - b.start[i];
        std::int32_t begin;
        wrong += misses(b.group[i / kFixedGroup], KeptSlabs{kept}, b.all.length, &begin);
        wrong += misses(b.ray[i].fixed, KeptSlabs{kept}, limit, &begin);
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(count > 80000);
  CHECK(hit_count > count / 4);
  CHECK(missed > count / 8);
}
