#include <doctest/doctest.h>

#include <string>

#include "accel/triangle.h"
#include "shade/shade_helpers.h"
#include "shade/surface.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

float between(Rng* rng, float low, float high) { return low + (high - low) * next_float(rng); }
Vec3 random_vec3(Rng* rng) { return {between(rng, -1, 1), between(rng, -1, 1), between(rng, -1, 1)}; }

// Spawns rays from points of random triangles on both sides and counts those that hit the triangle they leave.
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
    frame.kernels.surface(frame, {{0, 0, 0}, incoming, 1}, hit, &surface);
    float side = i % 2 ? 1.0f : -1.0f;
    float along = dot(outgoing, surface.geometric) * side;
    if (i % 4 == 1) outgoing = normalize(outgoing - surface.geometric * (along * side * 0.9999f));  // grazing
    along = dot(outgoing, surface.geometric) * side;
    if (!(along > 1e-6f)) continue;
    ShearedRay sheared;
    if (!make_sheared_ray({safe_origin(surface, side), outgoing, __builtin_inff()}, &sheared)) return spawns;
    const Triangle& triangle = frame.scene->triangles[hit.triangle];
    Hit again;
    hits += intersect_triangle(sheared, frame.geometry.positions[triangle.vertex(0)],
                               frame.geometry.positions[triangle.vertex(1)],
                               frame.geometry.positions[triangle.vertex(2)], &again) &&
            again.t > 0;
  }
  return hits;
}

// Hits a convex body from outside, a third of the rays aimed at edges and corners, and spawns a ray outward from each
// hit, which must hit nothing. Counts those that do.
int body_hits(GeneratedScene* s, const Vec3& center, int spawns) {
  auto t = ray_renderer(s);
  const Renderer& renderer = t->renderer;
  Rng rng = make_rng(12);
  int wrong = 0;
  float size = max_component(extent(renderer.accel.built.bounds));
  for (int i = 0; i < spawns; ++i) {
    const Triangle& triangle = renderer.scene.triangles[next_u32(&rng) % renderer.scene.triangles.count];
    Vec3 a = renderer.scene.positions[triangle.vertex(0)], b = renderer.scene.positions[triangle.vertex(1)];
    float along = i % 6 == 0 ? 0.0f : next_float(&rng);
    Vec3 target = i % 3 == 0 ? a + (b - a) * along : center + random_vec3(&rng) * (0.3f * size);
    Vec3 origin = center + normalize(random_vec3(&rng)) * (2 * size);
    Ray ray = {origin, target - origin, __builtin_inff()};
    Hit hit, again;
    renderer.accel.info->closest(renderer.accel.built, ray, nullptr, &hit, nullptr);
    if (hit.triangle == kNoTriangle) continue;
    Surface surface;
    renderer.frame.kernels.surface(renderer.frame, ray, hit, &surface);
    Vec3 outgoing = normalize(random_vec3(&rng));
    if (!surface.front) continue;  // at a vertex of the outline a hit on the back is equally valid
    if (dot(outgoing, surface.geometric) < 0) outgoing = -outgoing;
    if (!(dot(outgoing, surface.geometric) > 1e-6f)) continue;
    renderer.accel.info->closest(renderer.accel.built, {safe_origin(surface, 1), outgoing, __builtin_inff()}, nullptr,
                                 &again, nullptr);
    wrong += again.triangle != kNoTriangle;
  }
  return wrong;
}

}  // namespace

// Goal: the geometric normal of a triangle, to 16 ulp of a unit vector, on the side the ray came from. Method:
// triangles whose corners differ by multiples of 1/16, so that their edges are exact, near the origin and away from it;
// the normal in double.
TEST_CASE("hard_10_geometric_normal_is_within_16_ulp") {
  GeneratedScene s;
  std::uint32_t m = add_material(&s, matte(1));
  Rng rng = make_rng(10);
  auto on_grid = [&](int range) {
    return static_cast<float>(static_cast<int>(next_u32(&rng) % (2 * static_cast<unsigned>(range))) - range) / 16;
  };
  const std::uint32_t count = 2000;
  for (std::uint32_t i = 0; i < count; ++i) {
    float away = i % 2 ? 1000.0f : 0.0f;
    std::uint32_t first = 0;
    for (int corner = 0; corner < 3; ++corner) {
      float x = on_grid(16) + away, y = on_grid(16) - away;
      std::uint32_t vertex = add_vertex(&s, {x, y, on_grid(16)});
      if (corner == 0) first = vertex;
    }
    add_triangle(&s, first, first + 1, first + 2, m);
  }
  auto t = ray_renderer(&s);
  std::uint64_t tried = 0, wrong = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Triangle& triangle = s.triangles[i];
    Vec3d a = to_double(s.positions[triangle.vertex(0)]), b = to_double(s.positions[triangle.vertex(1)]),
          c = to_double(s.positions[triangle.vertex(2)]), n = normalize(cross(b - a, c - a));
    if (is_zero(n)) continue;
    for (const Vec3& incoming : {Vec3{0.3f, -0.5f, -0.8f}, Vec3{-0.3f, 0.5f, 0.8f}}) {
      if (std::fabs(dot(n, to_double(incoming))) < 1e-5) continue;  // either side
      Surface surface;
      t->renderer.frame.kernels.surface(t->renderer.frame, {{0, 0, 5}, incoming, 1}, {1, 0.25f, 0.25f, i}, &surface);
      Vec3d difference = to_double(surface.geometric) - (dot(n, to_double(incoming)) <= 0 ? n : -n);
      double error = max_component(Vec3d{std::fabs(difference.x), std::fabs(difference.y), std::fabs(difference.z)});
      wrong += !(error <= 16 * 0x1p-23), ++tried;
    }
  }
  CHECK(wrong == 0);
  CHECK(tried > count);
  count_hard(tried, wrong, "Ng within 16 ulp");
}

// Goal: a ray that leaves a surface does not hit it. Method: 10⁶ spawned rays per shape, a quarter of them grazing:
// spheres of sizes from 10⁻⁸ to 10⁸, at the origin and far from it, planes through zero coordinates.
TEST_CASE("hard_20_spawned_rays_do_not_meet_their_surface") {
  const int kSpawns = gate_share(250000, 1000000);
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
    int self = self_hits(&s, kSpawns), body = body_hits(&s, shape.center, kSpawns);
    CAPTURE(shape.radius);
    CHECK(self == 0);
    CHECK(body == 0);
    count_hard(2 * kSpawns, self + body, "0 self-hits");
  }
  for (float size : {1.0f, 1e8f, 1e-8f}) {
    GeneratedScene s;
    std::uint32_t m = add_material(&s, matte(1));
    add_sheet(&s, 0, m, false, size);
    add_quad(&s, {-size, 0, -size}, {size, 0, -size}, {size, 0, size}, {-size, 0, size}, m);
    add_quad(&s, {-size, size, 0}, {size, -size, 0}, {size, -size, size}, {-size, size, size}, m);
    int self = self_hits(&s, kSpawns);
    CAPTURE(size);
    CHECK(self == 0);
    count_hard(kSpawns, self, "0 self-hits");
  }
}

// Goal: of two surfaces a few ulp apart the nearer is visible, from either side, and the farther does not block light
// that falls on it. Method: sheets 4 ulp apart and more; shells of radius 1 and 1 + 4e-5.
TEST_CASE("hard_21_near_surface_of_a_narrow_gap_is_seen") {
  int smallest = 1 << 20, tried = 0, all_wrong = 0, rays = gate_share(5000, 100000);
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
    for (int i = 0; i < rays; ++i) {
      Vec3 target = random_vec3(&rng);
      target.z = near;
      wrong += look(*t, {2 * next_float(&rng), 0, 2}, target).x != 1;
      target.z = far;
      wrong += look(*t, {2 * next_float(&rng), 0, 0}, target).x != 0.25f;
    }
    if (wrong == 0 && ulps < smallest) smallest = ulps;
    CAPTURE(ulps);
    if (ulps >= 4) CHECK(wrong == 0);
    if (ulps >= 4) tried += 2 * rays, all_wrong += wrong;
  }
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
  for (int i = 0; i < 4 * rays; ++i) {
    Vec3 d = normalize(random_vec3(&rng));
    if (d.z < 0.2f) continue;
    ++tried;
    dark += !(look(*t, d * 5.0f, {0, 0, 0}).x > 0);
  }
  CHECK(dark == 0);
  std::string bound = "nearer is seen from 4 ulp on; smallest gap resolved: " + std::to_string(smallest) + " ulp";
  count_hard(tried, all_wrong + dark, bound.c_str());
}
