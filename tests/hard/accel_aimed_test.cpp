// Rays aimed where triangles meet: HARDCASES rows 1, 2, 13 and 16.
#include <doctest/doctest.h>

#include <cstdlib>

#include "accel/accel_world.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// The suite runs a share of the gate of 10^8; POCKETRAY_AIMED_RAYS asks for another number.
int aimed_ray_count(int usual) {
  const char* wanted = std::getenv("POCKETRAY_AIMED_RAYS");
  return wanted ? std::atoi(wanted) : effort(usual);
}

// A point of an edge of triangle i, in float as a user would compute it; a corner where `corner`.
Vec3 edge_point(const Mesh& mesh, std::uint32_t i, int side, float s, bool corner) {
  Vec3 a = mesh.positions[mesh.triangles[i].vertex[side]], b = mesh.positions[mesh.triangles[i].vertex[(side + 1) % 3]];
  return corner ? a : a + (b - a) * s;
}

struct Aimed {
  Mesh mesh;
  Vec3 center;
  float radius;  // the cube of this side about the center lies inside
};

// Rays from inside a closed mesh at its edges and corners: every one must hit. Returns how many miss or differ from
// brute force, which is asked about every `oracle_every`-th ray.
int misses_from_inside(const Aimed& aimed, const AccelInfo* info, int ray_count, int oracle_every) {
  auto world = make_world(aimed.mesh, info);
  auto oracle = make_world(aimed.mesh, &kBruteAccel);
  Rng rng = make_rng(201);
  int wrong = 0;
  for (int i = 0; i < ray_count; ++i) {
    Vec3 origin = aimed.center + random_vec3(&rng, 0.5f * aimed.radius);
    std::uint32_t triangle = next_u32(&rng) % aimed.mesh.triangles.size();
    int side = static_cast<int>(next_u32(&rng) % 3);
    float s = next_float(&rng);
    Ray ray = {origin, edge_point(aimed.mesh, triangle, side, s, i % 4 == 0) - origin, kInfinity};
    Hit hit = closest(*world, ray);
    wrong += hit.triangle == kNoTriangle;
    if (i % oracle_every == 0) wrong += !same_hit(hit, closest(*oracle, ray));
  }
  return wrong;
}

std::vector<Aimed> aimed_meshes() {
  std::vector<Aimed> list;
  for (float far : {0.0f, 1.0f, 1e3f, 1e5f}) {
    Vec3 center = {far, -0.7f * far, 0.3f * far};
    list.push_back({jittered_sphere(2, 1, center, 0.05f, 21), center, 1});
  }
  list.push_back({jittered_sphere(3, 1e-15f, {0, 0, 0}, 0.05f, 22), {0, 0, 0}, 1e-15f});
  list.push_back({jittered_sphere(3, 4e17f, {0, 0, 0}, 0.05f, 23), {0, 0, 0}, 4e17f});
  list.push_back({jittered_sphere(0, 1000, {0, 0, 0}, 0.1f, 24), {0, 0, 0}, 600});
  list.push_back({lattice_box(8), {4, 4, 4}, 4});
  return list;
}

}  // namespace

// Goal: no ray slips between triangles. Method: closed meshes near the origin, far from it, tiny and huge; rays from
// inside at points of edges and at corners; each must hit something.
TEST_CASE("hard_01_rays_aimed_at_edges_and_vertices_never_miss") {
  int per_mesh = aimed_ray_count(960000) / static_cast<int>(aimed_meshes().size());
  for (const AccelInfo* info : kAccelList) {
    bool slow = info == &kBruteAccel;
    for (const Aimed& aimed : aimed_meshes()) {
      INFO(info->name << ", radius " << aimed.radius << ", center " << aimed.center.x << ", rays " << per_mesh);
      CHECK(misses_from_inside(aimed, info, slow ? effort(500) : per_mesh, slow ? 1 << 30 : 500) == 0);
    }
  }
}

// Goal: the same from outside, where the ray has crossed half the tree's boxes edge-on. Method: a ray from outside
// through a point of an edge, well inside the outline, must hit; the hit is the one of brute force.
TEST_CASE("hard_01_rays_from_far_outside_aimed_at_edges_never_miss") {
  for (float distance : {3.0f, 1e3f, 1e5f}) {
    Mesh mesh = jittered_sphere(3, 1, {0, 0, 0}, 0.02f, 25);
    auto world = make_world(mesh, &kBvhAccel);
    Rng rng = make_rng(202);
    int missed = 0;
    for (int i = 0; i < effort(50000); ++i) {
      std::uint32_t triangle = next_u32(&rng) % mesh.triangles.size();
      Vec3 target = edge_point(mesh, triangle, i % 3, next_float(&rng), i % 4 == 0);
      Vec3 origin = normalize(target + random_vec3(&rng, 0.4f)) * distance;
      missed += closest(*world, {origin, target - origin, kInfinity}).triangle == kNoTriangle;
    }
    INFO("distance " << distance);
    CHECK(missed == 0);
  }
}

namespace {

struct Crossings {
  std::vector<std::uint32_t> ids;
  static bool collect(const void* context, std::uint32_t triangle, float, float) {
    static_cast<Crossings*>(const_cast<void*>(context))->ids.push_back(triangle);
    return false;  // so the traversal goes on to the last
  }
};

bool faces(const Mesh& mesh, std::uint32_t i, const Vec3& direction) {
  Vec3 a = mesh.positions[mesh.triangles[i].vertex[0]], b = mesh.positions[mesh.triangles[i].vertex[1]];
  return dot(cross(b - a, mesh.positions[mesh.triangles[i].vertex[2]] - a), direction) < 0;
}
bool share_vertex(const Triangle& a, const Triangle& b) {
  for (std::uint32_t v : a.vertex)
    for (std::uint32_t w : b.vertex)
      if (v == w) return true;
  return false;
}

}  // namespace

// Goal: a ray through a vertex makes one logical crossing, and its id is decided. Method: a convex sphere; all
// triangles a ray from outside meets (a filter that refuses all collects them) form one fan on the near side and one on
// the far side: an even number. The closest hit is the smallest id among those of smallest t, for every accelerator.
TEST_CASE("hard_02_rays_at_vertices_cross_once_and_have_a_decided_id") {
  Mesh mesh = jittered_sphere(3, 1, {0, 0, 0}, 0, 26);
  auto oracle = make_world(mesh, &kBruteAccel);
  for (const AccelInfo* info : kAccelList) {
    auto world = make_world(mesh, info);
    Rng rng = make_rng(203);
    int odd = 0, split_fans = 0, undecided = 0, several = 0;
    for (int i = 0; i < effort(3000); ++i) {
      Vec3 target = mesh.positions[next_u32(&rng) % mesh.positions.size()];
      Vec3 origin = normalize(target + random_vec3(&rng, 0.4f)) * 4.0f;
      Ray ray = {origin, target - origin, kInfinity};
      Crossings crossings;
      HitFilter filter = {Crossings::collect, &crossings};
      CHECK(closest(*world, ray, nullptr, &filter).triangle == kNoTriangle);
      std::vector<std::uint32_t> sides[2];
      for (std::uint32_t id : crossings.ids) sides[faces(mesh, id, ray.direction)].push_back(id);
      odd += sides[0].empty() != sides[1].empty() || sides[0].empty();
      several += sides[1].size() > 1;
      for (const auto& side : sides)
        for (std::uint32_t id : side) split_fans += !share_vertex(mesh.triangles[id], mesh.triangles[side[0]]);
      undecided += !same_hit(closest(*world, ray), closest(*oracle, ray));
    }
    INFO(info->name);
    CHECK(odd == 0);
    CHECK(split_fans == 0);
    CHECK(undecided == 0);
    CHECK(several > 0);  // rays did meet shared edges
  }
}

// Goal: flat boxes hide nothing. Method: meshes in the planes x = c, y = c, z = c, so that every box is flat, far from
// the origin and near; rays from both sides and grazing; the BVH's hits are brute force's.
TEST_CASE("hard_13_flat_boxes_are_entered_wherever_their_triangle_is_hit") {
  for (int axis = 0; axis < 3; ++axis)
    for (float plane : {0.0f, 0.1f, -1234.567f, 1e7f}) {
      Mesh mesh;
      Rng rng = make_rng(204);
      for (int i = 0; i < 120; ++i) {
        Vec3 p = random_vec3(&rng, 10), q = p + random_vec3(&rng, 4), r = p + random_vec3(&rng, 4);
        p[axis] = q[axis] = r[axis] = plane;
        add_triangle(&mesh, p, q, r);
      }
      auto world = make_world(mesh, &kBvhAccel), oracle = make_world(mesh, &kBruteAccel);
      int wrong = 0, hits = 0;
      for (int i = 0; i < effort(3000); ++i) {
        Vec3 target = edge_point(mesh, next_u32(&rng) % 120, i % 3, next_float(&rng), i % 5 == 0), origin = target;
        origin[axis] += between(&rng, -3, 3);
        if (i % 2) origin = origin + random_vec3(&rng, i % 4 == 1 ? 5.0f : 5e-4f);
        Ray ray = {origin, target - origin, kInfinity};
        if (is_zero(ray.direction)) continue;
        Hit expected = closest(*oracle, ray);
        wrong += !same_hit(expected, closest(*world, ray));
        hits += expected.triangle != kNoTriangle;
      }
      INFO("axis " << axis << ", plane " << plane);
      CHECK(wrong == 0);
      CHECK(hits > effort(1000));
    }
}

// Goal: axis-parallel rays on a lattice, whose boxes touch face to face, fall through no hole and do not wander.
// Method: rays along each axis through lattice points and lines; each hits twice (through the box); its node visits
// stay within twice those of rays moved by a fraction of a cell.
TEST_CASE("hard_16_axis_parallel_rays_on_a_lattice_find_no_hole_and_visit_few_nodes") {
  const int n = 16;
  auto world = make_world(lattice_box(n), &kBvhAccel);
  TraceStats exact, moved;
  int holes = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i <= 2 * n; ++i)
      for (int j = 0; j <= 2 * n; ++j)
        for (float sign : {1.0f, -1.0f}) {
          Vec3 origin, direction = {0, 0, 0};
          origin[axis] = sign > 0 ? -2.0f : n + 2.0f, direction[axis] = sign;
          origin[(axis + 1) % 3] = 0.5f * i, origin[(axis + 2) % 3] = 0.5f * j;
          Hit hit = closest(*world, {origin, direction, kInfinity}, &exact);
          holes += hit.triangle == kNoTriangle || hit.t != 2;
          origin[(axis + 1) % 3] += i < n ? 0.13f : -0.13f, origin[(axis + 2) % 3] += j < n ? 0.17f : -0.17f;
          holes += closest(*world, {origin, direction, kInfinity}, &moved).triangle == kNoTriangle;
        }
  CHECK(holes == 0);
  CHECK(exact.nodes <= 2 * moved.nodes);
}
