#include <doctest/doctest.h>

#include <cstdio>

#include "accel/triangle.h"
#include "shade/shade_helpers.h"
#include "shade/surface.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

float between(Rng* rng, float low, float high) { return low + (high - low) * next_float(rng); }
Vec3 random_vec3(Rng* rng) { return {between(rng, -1, 1), between(rng, -1, 1), between(rng, -1, 1)}; }

// Spawns rays from points of random triangles on both sides and counts those that meet the triangle they leave.
int self_hits(GeneratedScene* s, int spawns) {
  auto t = ray_renderer(s);
  const FrameData& frame = t->renderer.frame;
  Rng rng = make_rng(11);
  int hits = 0;
  for (int i = 0; i < spawns; ++i) {
    Hit hit;
    hit.triangle = next_u32(&rng) % frame.scene->triangles.count;
    hit.u = next_float(&rng);
    hit.v = next_float(&rng) * (1 - hit.u);
    if (i % 8 == 0) hit.u = 0;  // on the edges, too
    if (i % 8 == 3) hit.v = 0;
    if (i % 8 == 5) hit.v = 1 - hit.u;
    Vec3 incoming = random_vec3(&rng), outgoing = normalize(random_vec3(&rng));
    Surface surface;
    frame.surface(frame, {{0, 0, 0}, incoming, 1}, hit, &surface);
    float side = i % 2 ? 1.0f : -1.0f;
    float along = dot(outgoing, surface.geometric) * side;
    if (i % 4 == 1) outgoing = normalize(outgoing - surface.geometric * (along * side * 0.9999f));  // grazing
    along = dot(outgoing, surface.geometric) * side;
    if (!(along > 1e-6f)) continue;
    ShearedRay sheared;
    if (!make_sheared_ray({safe_origin(surface, side), outgoing, __builtin_inff()}, &sheared)) return spawns;
    const Triangle& triangle = frame.scene->triangles[hit.triangle];
    Hit again;
    hits += intersect_triangle(sheared, frame.positions[triangle.vertex[0]], frame.positions[triangle.vertex[1]],
                               frame.positions[triangle.vertex[2]], &again) &&
            again.t > 0;
  }
  return hits;
}

}  // namespace

// Goal: a ray that leaves a surface does not meet it. Method: 10⁶ spawns per shape, a quarter of them grazing: spheres
// of sizes from 10⁻⁸ to 10⁸, at the origin and far from it, planes through zero coordinates.
TEST_CASE("hard_20_spawned_rays_do_not_meet_their_surface") {
  constexpr int kSpawns = effort(1000000);
  struct Shape {
    const char* name;
    Vec3 center;
    float radius;
  };
  const Shape spheres[] = {{"unit", {0, 0, 0}, 1},
                           {"huge", {0, 0, 0}, 1e8f},
                           {"tiny", {0, 0, 0}, 1e-8f},
                           {"far", {1e8f, -3e7f, 2e8f}, 1e6f},
                           {"near far", {1000, 0, 0}, 0.5f}};
  for (const Shape& shape : spheres) {
    GeneratedScene s;
    add_sphere(&s, shape.center, shape.radius, 12, 8, add_material(&s, matte(1)));
    CAPTURE(shape.radius);
    CHECK(self_hits(&s, kSpawns) == 0);
  }
  for (float size : {1.0f, 1e8f, 1e-8f}) {
    GeneratedScene s;
    std::uint32_t m = add_material(&s, matte(1));
    add_sheet(&s, 0, m, false, size);
    add_quad(&s, {-size, 0, -size}, {size, 0, -size}, {size, 0, size}, {-size, 0, size}, m);
    add_quad(&s, {-size, size, 0}, {size, -size, 0}, {size, -size, size}, {-size, size, size}, m);
    CAPTURE(size);
    CHECK(self_hits(&s, kSpawns) == 0);
  }
}

// Goal: of two surfaces a few ulp apart the nearer is seen, from either side, and light that falls on it is not cut off
// by the farther. Method: sheets 4 ulp apart and more; shells of radius 1 and 1 + 4e-5.
TEST_CASE("hard_21_near_surface_of_a_narrow_gap_is_seen") {
  int smallest = 1 << 20;
  for (int ulps : {1, 2, 4, 8, 64, 4096}) {
    float far = 1, near = 1;
    for (int i = 0; i < ulps; ++i) near = std::nextafterf(near, 2);
    GeneratedScene s;
    std::uint32_t a = add_material(&s, unlit(0.25f)), b = add_material(&s, unlit(1));
    add_sheet(&s, far, a);
    add_sheet(&s, near, b);
    auto t = ray_renderer(&s);
    Rng rng = make_rng(7);
    int wrong = 0;
    for (int i = 0; i < effort(5000); ++i) {
      Vec3 target = random_vec3(&rng);
      target.z = near;
      wrong += look(*t, {2 * next_float(&rng), 0, 2}, target).x != 1;
      target.z = far;
      wrong += look(*t, {2 * next_float(&rng), 0, 0}, target).x != 0.25f;
    }
    if (wrong == 0 && ulps < smallest) smallest = ulps;
    CAPTURE(ulps);
    if (ulps >= 4) CHECK(wrong == 0);
  }
  std::printf("smallest gap resolved by eye rays at distance 1: %d ulp\n", smallest);
  GeneratedScene s;
  std::uint32_t inner = add_material(&s, matte(0)), outer = add_material(&s, matte(1));
  add_sphere(&s, {0, 0, 0}, 1, 16, 12, inner);
  add_sphere(&s, {0, 0, 0}, 1 + 4e-5f, 16, 12, outer);
  Light light;
  light.kind = LightKind::directional;
  light.direction = {0, 0, -1};
  s.lights.push_back(light);
  auto t = ray_renderer(&s);
  Rng rng = make_rng(8);
  int dark = 0;
  for (int i = 0; i < effort(20000); ++i) {
    Vec3 d = normalize(random_vec3(&rng));
    if (d.z < 0.2f) continue;
    dark += !(look(*t, d * 5.0f, {0, 0, 0}).x > 0);
  }
  CHECK(dark == 0);
}
