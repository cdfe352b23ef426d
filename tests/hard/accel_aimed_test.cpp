// Rays aimed at edges and vertices: HARDCASES rows 1, 2, 13 and 16.
#include <doctest/doctest.h>

#include "accel/variant.h"
#include "support/effort.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// A point on an edge of triangle i, in float as a user would compute it; with `corner`, a vertex.
Vec3 edge_point(const Mesh& mesh, std::uint32_t i, int side, float s, bool corner) {
  Vec3 a = mesh.positions[mesh.triangles[i].vertex(side)], b = mesh.positions[mesh.triangles[i].vertex((side + 1) % 3)];
  return corner ? a : a + (b - a) * s;
}

struct Aimed {
  Mesh mesh;
  Vec3 center;
  float radius;  // a cube of this side about the center lies inside
};

// Rays from inside a closed mesh at its edges and corners, in groups with a common origin: every one must hit. Returns
// the number that miss or, for one group in `oracle_every`, differ from brute force.
int wrong_from_inside(const Variant& variant, const World& world, const World& oracle, const Aimed& aimed, Rng* rng,
                      int ray_count, int oracle_every) {
  int wrong = 0;
  Ray rays[kGroupMax];
  Hit hits[kGroupMax];
  for (int begin = 0, group = 0; begin < ray_count; begin += kGroupMax, ++group) {
    int count = std::min(kGroupMax, ray_count - begin);
    Vec3 origin = aimed.center + random_vec3(rng, 0.5f * aimed.radius);
    for (int i = 0; i < count; ++i) {
      std::uint32_t triangle = next_u32(rng) % aimed.mesh.triangles.size();
      int side = static_cast<int>(next_u32(rng) % 3);
      float s = next_float(rng);
      rays[i] = {origin, edge_point(aimed.mesh, triangle, side, s, i % 4 == 0) - origin, kInfinity};
    }
    answer(variant, world, rays, count, nullptr, hits);
    for (int i = 0; i < count; ++i) {
      wrong += hits[i].triangle == kNoTriangle;
      if (group % oracle_every == 0) wrong += !same_hit(hits[i], closest(oracle, rays[i]));
    }
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
// inside at points of edges and at corners; each must hit, and some are compared with brute force.
TEST_CASE("hard_01_rays_aimed_at_edges_and_vertices_never_miss") {
  std::vector<Aimed> meshes = aimed_meshes();
  std::vector<Variant> variants = all_variants();
  int per_mesh =
      gate_share(kSoftFloats ? 800000 : 4800000, 100000000) / static_cast<int>(meshes.size() * variants.size());
  for (const Variant& variant : variants)
    for (const Aimed& aimed : meshes) {
      auto world = make_world(aimed.mesh, variant.accel), oracle = make_world(aimed.mesh, &kBruteAccel);
      std::uint64_t wrong = count_wrong(per_mesh, 201, [&](Rng* rng, int count) {
        return wrong_from_inside(variant, *world, *oracle, aimed, rng, count, whole_gate() ? 256 : 32);
      });
      INFO(name_of(variant) << ", radius " << aimed.radius << ", center " << aimed.center.x);
      CHECK(wrong == 0);
      count_hard(per_mesh, wrong, "0 misses");
    }
}

// Goal: the same from outside, where the ray has crossed half the tree's boxes edge-on. Method: a ray from outside
// through a point of an edge, well inside the outline, must hit.
TEST_CASE("hard_01_rays_from_far_outside_aimed_at_edges_never_miss") {
  Mesh mesh = jittered_sphere(3, 1, {0, 0, 0}, 0.02f, 25);
  std::vector<Variant> variants = all_variants();
  int per_distance = gate_share(300000, 10000000) / static_cast<int>(3 * variants.size());
  for (const Variant& variant : variants) {
    auto world = make_world(mesh, variant.accel);
    for (float distance : {3.0f, 1e3f, 1e5f}) {
      auto missed = [&](Rng* rng, int count) {
        int misses = 0;
        for (int i = 0; i < count; ++i) {
          std::uint32_t triangle = next_u32(rng) % mesh.triangles.size();
          Vec3 target = edge_point(mesh, triangle, i % 3, next_float(rng), i % 4 == 0);
          Vec3 origin = normalize(target + random_vec3(rng, 0.4f)) * distance;
          Ray ray = {origin, target - origin, kInfinity};
          Hit hit;
          answer(variant, *world, &ray, 1, nullptr, &hit);
          misses += hit.triangle == kNoTriangle;
        }
        return misses;
      };
      std::uint64_t wrong = count_wrong(per_distance, 202, missed);
      INFO(name_of(variant) << ", distance " << distance);
      CHECK(wrong == 0);
      count_hard(per_distance, wrong, "0 misses");
    }
  }
}

namespace {

struct Crossings {
  std::vector<std::uint32_t> ids;
  static bool collect(const void* context, std::uint32_t triangle, float, float) {
    static_cast<Crossings*>(const_cast<void*>(context))->ids.push_back(triangle);
    return false;  // continues the traversal to the end
  }
};

bool faces(const Mesh& mesh, std::uint32_t i, const Vec3& direction) {
  Vec3 a = mesh.positions[mesh.triangles[i].vertex(0)], b = mesh.positions[mesh.triangles[i].vertex(1)];
  return dot(cross(b - a, mesh.positions[mesh.triangles[i].vertex(2)] - a), direction) < 0;
}
bool share_vertex(const Triangle& a, const Triangle& b) {
  for (std::uint32_t v : a.vertices())
    for (std::uint32_t w : b.vertices())
      if (v == w) return true;
  return false;
}

}  // namespace

// Goal: a ray through a vertex crosses the surface once, with a well-defined id. Method: a convex sphere; the triangles
// that a ray from outside meets (collected by a filter that rejects all) form one fan on the near side and one on the
// far side: an even number. The closest hit is the smallest id among those of smallest t, for every accelerator.
TEST_CASE("hard_02_rays_at_vertices_cross_once_and_have_a_decided_id") {
  Mesh mesh = jittered_sphere(3, 1, {0, 0, 0}, 0, 26);
  auto oracle = make_world(mesh, &kBruteAccel);
  int rays = gate_share(3000, 100000);
  for (const AccelInfo* info : kAccelList) {
    auto world = make_world(mesh, info);
    Rng rng = make_rng(203);
    int odd = 0, split_fans = 0, undecided = 0, several = 0, refused = 0;
    for (int i = 0; i < rays; ++i) {
      Vec3 target = mesh.positions[next_u32(&rng) % mesh.positions.size()];
      Vec3 origin = normalize(target + random_vec3(&rng, 0.4f)) * 4.0f;
      Ray ray = {origin, target - origin, kInfinity};
      Crossings crossings;
      HitFilter filter = {Crossings::collect, &crossings};
      refused += closest(*world, ray, nullptr, &filter).triangle == kNoTriangle;
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
    CHECK(refused == rays);
    count_hard(rays, odd + split_fans + undecided, "even parity, the id of brute force");
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
      for (const Variant& variant : all_variants()) {
        auto world = make_world(mesh, variant.accel), oracle = make_world(mesh, &kBruteAccel);
        Tally tally;
        for (int i = 0; i < gate_share(3000, 60000); ++i) {
          Vec3 target = edge_point(mesh, next_u32(&rng) % 120, i % 3, next_float(&rng), i % 5 == 0), origin = target;
          origin[axis] += between(&rng, -3, 3);
          if (i % 2) origin = origin + random_vec3(&rng, i % 4 == 1 ? 5.0f : 5e-4f);
          Ray ray = {origin, target - origin, kInfinity};
          if (!is_zero(ray.direction)) compare(variant, *world, *oracle, ray, &tally);
        }
        INFO("axis " << axis << ", plane " << plane << ", " << name_of(variant));
        CHECK(tally.wrong == 0);
        CHECK(tally.hits > tally.rays / 4);
        count_hard(tally.rays, tally.wrong, "0 drops");
      }
    }
}

// Goal: axis-parallel rays on a lattice, whose boxes touch face to face, fall through no hole and visit few nodes.
// Method: rays along each axis through lattice points and lines; each hits twice (through the box); its node visits
// stay within twice those of rays moved by a fraction of a cell.
TEST_CASE("hard_16_axis_parallel_rays_on_a_lattice_find_no_hole_and_visit_few_nodes") {
  const int n = 16;
  for (const Variant& variant : all_variants()) {
    auto world = make_world(lattice_box(n), variant.accel);
    TraceStats exact, moved;
    int holes = 0, rays = 0;
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
            rays += 2;
          }
    INFO(name_of(variant));
    CHECK(holes == 0);
    CHECK(exact.nodes <= 2 * moved.nodes);
    count_hard(rays, holes, "0 holes, at most 2 x the nodes of a moved ray");
  }
}
