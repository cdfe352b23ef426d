#include <doctest/doctest.h>

#include <cfenv>
#include <cmath>

#include "accel/accel_world.h"
#include "accel/triangle.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// A ray near the mesh: from outside or inside, at a random point, a vertex, an edge or along an axis.
Ray ray_about(Rng* rng, const Mesh& mesh, const Box& bounds) {
  Vec3 middle = is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds);
  float size = is_empty(bounds) ? 1.0f : max_component(extent(bounds));
  Vec3 origin = middle + random_vec3(rng, size * (next_u32(rng) % 2 ? 2.0f : 0.6f));
  Vec3 target = middle + random_vec3(rng, size * 0.6f);
  if (!mesh.triangles.empty() && next_u32(rng) % 4 != 0) {
    const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
    Vec3 a = mesh.positions[t.vertex(0)], b = mesh.positions[t.vertex(1)];
    target = next_u32(rng) % 2 ? a : a + (b - a) * next_float(rng);
    if (next_u32(rng) % 8 == 0) origin = a;
    if (next_u32(rng) % 4 == 0) {
      int axis = static_cast<int>(next_u32(rng) % 3);
      float along = origin[axis];
      origin = target, origin[axis] = along;
    }
  }
  return {origin, target - origin, next_u32(rng) % 4 ? kInfinity : 0.9f};
}

}  // namespace

namespace {

// Rejects odd triangles, and half of each even one, where u > v; counts calls.
struct Sieve {
  mutable int asked = 0;
  static bool accept(const void* context, std::uint32_t triangle, float u, float v) {
    ++static_cast<const Sieve*>(context)->asked;
    return triangle % 2 == 0 && u <= v;
  }
};

}  // namespace

// Goal: a filter decides which hits count, and receives the hit's own u and v. Method: compare with brute force under
// the same filter, and check that returned hits pass it; a filter without a function accepts everything.
TEST_CASE("accel_filter_is_respected") {
  Mesh mesh = soup("soup", 300, 1, 0.7f, 103);
  auto oracle = make_world(mesh, &kBruteAccel);
  Sieve sieve;
  HitFilter filter = {Sieve::accept, &sieve}, none;
  for (const AccelInfo* info : kAccelList) {
    auto world = make_world(mesh, info);
    Rng rng = make_rng(104);
    int wrong = 0, passed = 0, changed = 0;
    for (int i = 0; i < effort(3000); ++i) {
      Ray ray = {random_vec3(&rng, 1), random_vec3(&rng, 1), kInfinity};
      Hit hit = closest(*world, ray, nullptr, &filter), expected = closest(*oracle, ray, nullptr, &filter);
      Hit unfiltered = closest(*world, ray, nullptr, &none);
      wrong += !same_hit(hit, expected) || !same_hit(unfiltered, closest(*oracle, ray));
      bool found = hit.triangle != kNoTriangle;
      wrong += found && !(hit.triangle % 2 == 0 && hit.u <= hit.v);
      wrong += info->occluded(world->accel, ray, &filter, nullptr) != found;
      passed += found, changed += hit.triangle != unfiltered.triangle;
    }
    INFO(info->name);
    CHECK(wrong == 0);
    CHECK(passed > effort(1000));
    CHECK(changed > effort(1000));
    CHECK(sieve.asked > effort(3000));
  }
}

// Goal: among hits of equal t the smallest id wins, wherever it lies in the structure. Method: a fan of overlapping
// coplanar triangles in shuffled order, and their common edges.
TEST_CASE("accel_ties_go_to_the_smallest_id") {
  Mesh mesh;
  Rng rng = make_rng(105);
  for (int i = 0; i < 200; ++i) {
    float s = 1 + static_cast<float>(next_u32(&rng) % 8);
    add_triangle(&mesh, {-s, -s, 0.5f}, {s, -s, 0.5f}, {0, s, 0.5f});
  }
  for (const AccelInfo* info : kAccelList) {
    auto world = make_world(mesh, info);
    int wrong = 0;
    for (int i = 0; i < effort(1000); ++i) {
      Vec3 origin = random_vec3(&rng, 6);
      origin.z = i % 2 ? 4.0f : -4.0f;
      std::uint32_t least = kNoTriangle;
      for (std::uint32_t t = 200; t-- > 0;) {
        Mesh one;
        for (std::uint32_t v : mesh.triangles[t].vertices()) one.positions.push_back(mesh.positions[v]);
        float s = one.positions[1].x;
        if (origin.y >= -s && origin.y <= s - 2 * std::fabs(origin.x)) least = t;
      }
      wrong += closest(*world, {origin, {0, 0, origin.z < 0 ? 1.0f : -1.0f}, kInfinity}).triangle != least;
    }
    INFO(info->name);
    CHECK(wrong <= 2);  // the closed form above rounds at the edges
  }
}

// Goal: no traversal raises the invalid-operation flag (0·∞, ∞ − ∞), so that nothing depends on how a CPU handles NaN.
// Method: the rays above, over all meshes, including axis-parallel rays in box faces; the flag stays down.
TEST_CASE("accel_raises_no_invalid_operation") {
  for (const Mesh& mesh : generated_meshes())
    for (const AccelInfo* info : kAccelList) {
      auto world = make_world(mesh, info);
      Rng rng = make_rng(109);
      std::feclearexcept(FE_ALL_EXCEPT);
      for (int i = 0; i < effort(1000); ++i) closest(*world, ray_about(&rng, mesh, world->accel.bounds));
      INFO(mesh.name << ", " << info->name);
      CHECK(std::fetestexcept(FE_INVALID) == 0);
    }
}

namespace {

// Values that fall with the squared distance to a point, less for some triangles than their boxes allow.
struct NearPoint {
  const Mesh* mesh;
  Vec3 point;
  mutable int asked = 0;  // triangles

  static float value(const Vec3& p, const Box& box) {
    const Vec3 d = max(max(box.low - p, p - box.high), Vec3{0, 0, 0});
    return 1 / (1 + dot(d, d));
  }
  static float box_value(const void* context, const Box& box) {
    return value(static_cast<const NearPoint*>(context)->point, box);
  }
  static float triangle_value(const void* context, std::uint32_t id) {
    const NearPoint& near = *static_cast<const NearPoint*>(context);
    ++near.asked;
    Box box = empty_box();
    for (std::uint32_t v : near.mesh->triangles[id].vertices()) box = merge(box, near.mesh->positions[v]);
    return value(near.point, box) / static_cast<float>(1 + id % 3);
  }
  TriangleQuery query() const { return {this, box_value, triangle_value}; }
};

}  // namespace

// Goal: largest() finds the largest value of any triangle that rays can hit, to the bit. Method: brute force over the
// mesh; points inside and outside.
TEST_CASE("accel_finds_the_largest_value_of_a_triangle") {
  for (const Mesh& mesh : generated_meshes()) {
    for (const AccelInfo* info : kAccelList) {
      auto world = make_world(mesh, info);
      Rng rng = make_rng(106);
      Box bounds = world->accel.bounds;
      float size = is_empty(bounds) ? 1.0f : max_component(extent(bounds));
      int wrong = 0;
      for (int i = 0; i < effort(60); ++i) {
        const NearPoint near = {&mesh, (is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds)) + random_vec3(&rng, size)};
        float most = 0;
        for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id)
          if (is_hittable(world->accel.positions, mesh.triangles[id]))
            most = std::fmax(most, NearPoint::triangle_value(&near, id));
        wrong += !same_bits(info->largest(world->accel, near.query()), most);
      }
      INFO(mesh.name << ", " << info->name);
      CHECK(wrong == 0);
    }
  }
}

// Goal: a hierarchy asks for few triangles, and none has the value 0. Method: triangles of a sphere near a point.
TEST_CASE("accel_asks_few_triangles_for_the_largest_value") {
  const Mesh mesh = jittered_sphere(5, 1, {0, 0, 0}, 0, 107);
  for (const AccelInfo* info : {&kBvhAccel, &kCompactAccel}) {
    auto sphere = make_world(mesh, info);
    const NearPoint near = {&mesh, {0, 5, 0.1f}};
    CHECK(info->largest(sphere->accel, near.query()) == doctest::Approx(1 / 17.0).epsilon(0.01));
    CHECK(near.asked < static_cast<int>(mesh.triangles.size()) / 20);
    const Mesh empty;
    CHECK(info->largest(make_world(empty, info)->accel, NearPoint{&empty, {0, 0, 0}}.query()) == 0);
  }
}

// Goal: build() takes no more than need() says, keeps no more than its data, and returns its scratch; on a mesh the
// default stays within 53 bytes a triangle, the compact one within 16. Method: every generated mesh; a sphere of 20,480
// triangles.
TEST_CASE("accel_memory_is_within_its_plan") {
  for (const AccelInfo* info : kAccelList) {
    for (const Mesh& mesh : generated_meshes()) {
      auto world = make_world(mesh, info);
      std::uint32_t count = static_cast<std::uint32_t>(mesh.triangles.size());
      INFO(mesh.name << ", " << info->name);
      CHECK(world->keep.used_max <= info->need(count));
      CHECK(world->keep.used == arena_need(world->accel.data.bytes()));
      CHECK(world->scratch.used_max <= info->scratch_need(count));
      CHECK(world->scratch.used == 0);
    }
    auto sphere = make_world(jittered_sphere(5, 1, {0, 0, 0}, 0.01f, 108), info);
    CHECK(sphere->accel.data.bytes() <= (info == &kCompactAccel ? 16 : 53) * sphere->triangles.size());
  }
}
