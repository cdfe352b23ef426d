// The tree around the triangle test: HARDCASES rows 8, 11, 12, 14, 15 and 17 to 19.
#include <doctest/doctest.h>

#include <algorithm>

#include "accel/bvh.h"
#include "accel/oracle.h"
#include "accel/variant.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Longest path from the root, in nodes.
std::uint32_t depth_of(const World& world) {
  BvhView bvh(world.accel.data.data);
  std::vector<std::uint32_t> depth(bvh.header->node_count, 1);
  for (std::uint32_t i = 0; i < bvh.header->node_count; ++i)
    for (std::uint32_t child : bvh.nodes[i].child)
      if (!(child & kLeafBit)) depth[child] = depth[i] + 1;
  return *std::max_element(depth.begin(), depth.end());
}

// Whether every child's box is exactly the bounds of its content, and each triangle lies in one leaf.
bool is_sound(const World& world) {
  Accel copy = world.accel;
  return world.info->adopt(&copy, world.accel.data, {}).ok;
}

bool contains_children(const World& world, const LeafKind& kind) {
  BvhView bvh(world.accel.data.data);
  for (std::uint32_t i = 0; i < bvh.header->node_count; ++i)
    for (int lane = 0; lane < 4; ++lane) {
      std::uint32_t child = bvh.nodes[i].child[lane];
      if (child == kNoChild) continue;
      Box box = child_box(bvh.nodes[i], lane);
      if (!(child & kLeafBit)) {
        if (!contains(box, node_box(bvh.nodes[child]))) return false;
        continue;
      }
      const std::uint8_t* leaf = leaf_at(kind, world.accel.data.data, child & kLeafIndexMask);
      for (std::uint32_t k = 0; k < leaf_triangle_count(child); ++k) {
        const std::uint32_t id = leaf_ids(kind, leaf)[k];
        for (std::uint32_t v = 0; v < 3 && !(id & kUnhittableBit); ++v) {
          Vec3 p = world.accel.positions[world.accel.triangles[id].vertex(v)];
          if (!contains(box, {p, p})) return false;
        }
      }
    }
  return true;
}

// Traces rays at and around the mesh; returns how many answers differ from brute force.
int wrong_answers(const Variant& variant, const World& world, const Mesh& mesh, int ray_count, std::uint64_t seed) {
  auto oracle = make_world(mesh, &kBruteAccel);
  Rng rng = make_rng(seed);
  Tally tally;
  Vec3 size = extent(oracle->accel.bounds), low = oracle->accel.bounds.low;
  for (int i = 0; i < ray_count; ++i) {
    Vec3 f = {next_float(&rng), next_float(&rng), next_float(&rng)};
    Vec3 origin = low + size * f + random_vec3(&rng, max_component(size)), target = origin + random_vec3(&rng, 1);
    const Triangle& t = mesh.triangles[next_u32(&rng) % mesh.triangles.size()];
    if (i % 4) target = mesh.positions[t.vertex(i % 3)] * 0.5f + mesh.positions[t.vertex((i + 1) % 3)] * 0.5f;
    Ray ray = {origin, target - origin, kInfinity};
    compare(variant, world, *oracle, ray, &tally);
  }
  return static_cast<int>(tally.wrong);
}

}  // namespace

// Goal: vertices that are NaN, infinite or beyond 1e18 and indices out of range exclude their triangle and no other;
// denormal and huge ones count. Method: spoil a third of a mesh; 10^4 rays agree with the double oracle and brute
// force.
TEST_CASE("hard_08_spoilt_triangles_are_left_out_and_the_rest_agrees_with_brute_force") {
  const float spoilt[] = {kNan, kInfinity, -kInfinity, 2e18f, -3e38f};
  for (float scale : {1.0f, 1e-39f, 4e17f}) {
    Mesh mesh = soup("", 150, 1, 0.7f, 41), good;
    for (Vec3& p : mesh.positions) p = p * scale;
    good = mesh;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      for (std::uint32_t corner : {1u, 2u}) good.triangles[i].set_vertex(corner, good.triangles[i].vertex(0));
      std::uint32_t vertex = mesh.triangles[i].vertex(i / 3 % 3);
      if (i % 2) {
        mesh.positions[vertex][static_cast<int>(i / 9 % 3)] = spoilt[i % 5];
      } else {
        std::uint32_t first = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.triangles[i].set_vertex(1, i % 4 ? kVertexCountMax - 1 : first);
      }
    }
    auto oracle = make_world(good, &kBruteAccel);
    for (const AccelInfo* info : kAccelList) {
      auto world = make_world(mesh, info);
      CHECK(world->accel.bounds.high.x <= kCoordinateMax);
      Rng rng = make_rng(401);
      int wrong = 0, wrong_in_double = 0, decided = 0, hits = 0;
      int rays = effort(10000);
      for (int i = 0; i < rays; ++i) {
        Ray ray = {random_vec3(&rng, 2 * scale), random_vec3(&rng, 1), kInfinity};
        Hit hit = closest(*world, ray);
        wrong += !same_hit(hit, closest(*oracle, ray));
        hits += hit.triangle != kNoTriangle;
        if (i % 20 == 0 && scale > 1e-30f) wrong_in_double += !oracle_agrees(*oracle, ray, hit, 4, &decided);
      }
      INFO(info->name << ", scale " << scale);
      CHECK(wrong == 0);
      CHECK(wrong_in_double == 0);
      CHECK(hits > effort(1500));
      if (scale > 1e-30f) CHECK(decided > effort(400));
      count_hard(rays, wrong + wrong_in_double, "as brute force");
    }
  }
}

// Goal: for every combination of signs and zeros in the direction, including -0, hits match brute force. Method: soup
// and lattice, origins at vertices' coordinates so that slabs are met on their faces.
TEST_CASE("hard_11_all_sign_and_zero_combinations_of_the_direction_are_as_brute_force") {
  const float values[] = {-1, -0.0f, 0.0f, 1, -1e-30f, 1e-30f, 0.3f};
  for (const Mesh& mesh : {lattice_box(6), soup("soup", 300, 4, 2, 42)})
    for (const Variant& variant : all_variants()) {
      auto world = make_world(mesh, variant.accel), oracle = make_world(mesh, &kBruteAccel);
      Rng rng = make_rng(402);
      Tally tally;
      for (int combination = 0; combination < 343; ++combination)
        for (int i = 0; i < gate_share(20, 400); ++i) {
          Vec3 direction = {values[combination % 7], values[combination / 7 % 7], values[combination / 49]};
          Vec3 p = mesh.positions[next_u32(&rng) % mesh.positions.size()], origin = random_vec3(&rng, 6);
          for (int axis = 0; axis < 3; ++axis)
            if (next_u32(&rng) % 2) origin[axis] = p[axis];
          compare(variant, *world, *oracle, {origin, direction, kInfinity}, &tally);
        }
      INFO(mesh.name << ", " << name_of(variant));
      CHECK(tally.wrong == 0);
      CHECK(tally.hits > tally.rays / 10);
      count_hard(tally.rays, tally.wrong, "the bits of brute force");
    }
}

// Goal: rays that lie in faces of boxes, where slabs give 0·∞, match brute force. Method: a lattice, whose boxes have
// their faces at integers; integral origins, directions along axes and face diagonals, from inside and outside.
TEST_CASE("hard_12_rays_lying_in_box_faces_are_as_brute_force") {
  const int n = 5;
  Mesh mesh = lattice_box(n);
  for (const Variant& variant : all_variants()) {
    auto world = make_world(mesh, variant.accel), oracle = make_world(mesh, &kBruteAccel);
    Tally tally;
    for (int d = 0; d < 27; ++d)
      for (int i = 0; i < 8 * 8 * 8; i += kSoftFloats ? 5 : 1) {
        Vec3 origin = {float(i % 8 - 1), float(i / 8 % 8 - 1), float(i / 64 - 1)};
        Vec3 direction = {float(d % 3 - 1), float(d / 3 % 3 - 1), float(d / 9 - 1)};
        compare(variant, *world, *oracle, {origin, direction, kInfinity}, &tally);
      }
    INFO(name_of(variant));
    CHECK(tally.wrong == 0);
    CHECK(tally.hits > tally.rays / 5);
    count_hard(tally.rays, tally.wrong, "the bits of brute force");
  }
}

// Goal: the data that a compact structure omits hides no hit. Ours quantises no box and stores no vertex: every node
// holds the exact box of its content, like the default's, and hits are the default's. Method: all nodes of all
// generated meshes; rays against the default, with every instruction set, one by one and in packets.
TEST_CASE("hard_17_compact_nodes_hold_the_exact_boxes_and_hits_are_those_of_the_default") {
  for (const Mesh& mesh : generated_meshes()) {
    auto full = make_world(mesh, &kBvhAccel), compact = make_world(mesh, &kCompactAccel);
    BvhView a(full->accel.data.data), b(compact->accel.data.data);
    INFO(mesh.name);
    CHECK(contains_children(*compact, kCompactLeaves));
    REQUIRE(a.header->node_count == b.header->node_count);
    CHECK(std::memcmp(a.nodes, b.nodes, sizeof(BvhNode) * a.header->node_count) == 0);
    if (mesh.triangles.empty()) continue;
    CHECK(compact->accel.data.bytes() < full->accel.data.bytes());
    for (const Variant& variant : all_variants()) {
      if (variant.accel->magic != kCompactAccel.magic) continue;
      Rng rng = make_rng(409);
      int rays = gate_share(200, 10000), wrong = 0;
      for (int i = 0; i < rays; ++i) {
        Vec3 target = mesh.positions[next_u32(&rng) % mesh.positions.size()];
        Ray ray = {random_vec3(&rng, 4), {}, i % 3 ? kInfinity : 1.0f};
        ray.direction = target - ray.origin + random_vec3(&rng, i % 2 ? 0.1f : 0);
        Hit hit, expected = closest(*full, ray);
        answer(variant, *compact, &ray, 1, nullptr, &hit);
        wrong += !same_hit(hit, expected) ||
                 kCompactAccel.occluded(compact->accel, ray, nullptr, nullptr) != (expected.triangle != kNoTriangle);
      }
      INFO(name_of(variant));
      CHECK(wrong == 0);
      count_hard(rays, wrong, "the hits of exact nodes");
    }
  }
}

// Goal: rays through corners and along edges of any box that a tree or a grid may put around triangles match brute
// force, from outside and from the boundary, with triangles that span many boxes among small ones. Method: every face
// of such a box lies at a coordinate of some vertex; corners, edges and origins are made of those.
TEST_CASE("hard_18_rays_through_box_corners_and_on_boundaries_are_as_brute_force") {
  Mesh mixed = soup("small and spanning", 300, 1, 0.1f, 45);
  Rng shapes = make_rng(47);
  for (int i = 0; i < 20; ++i)
    add_triangle(&mixed, random_vec3(&shapes, 1), random_vec3(&shapes, 1), random_vec3(&shapes, 1));
  for (const Mesh& mesh : {mixed, lattice_box(8)})
    for (const Variant& variant : all_variants()) {
      auto world = make_world(mesh, variant.accel), oracle = make_world(mesh, &kBruteAccel);
      Rng rng = make_rng(409);
      auto coordinate = [&](int axis) { return mesh.positions[next_u32(&rng) % mesh.positions.size()][axis]; };
      auto corner = [&] { return Vec3{coordinate(0), coordinate(1), coordinate(2)}; };
      Tally tally;
      for (int i = 0; i < gate_share(4000, 100000); ++i) {
        Vec3 target = corner(), origin = corner();
        int axis = i % 3;
        if (i % 4 == 0) origin = target, origin[axis] = coordinate(axis);           // along an edge
        if (i % 4 == 1) origin[axis] = target[axis];                                // within a face
        if (i % 4 == 2) origin = origin + normalize(random_vec3(&rng, 1)) * 20.0f;  // through a corner, from outside
        compare(variant, *world, *oracle, {origin, target - origin, kInfinity}, &tally);
      }
      INFO(mesh.name << ", " << name_of(variant));
      CHECK(tally.wrong == 0);
      CHECK(tally.hits > tally.rays / 4);
      count_hard(tally.rays, tally.wrong, "the bits of brute force");
    }
}

// Goal: with triangles that no division can tell apart, the build ends within the planned depth and bytes (make_world()
// gives the arenas exactly what need() says). Method: 10^4 identical triangles; 10^4 with the same centroid.
TEST_CASE("hard_14_identical_triangles_and_equal_centroids_end_the_build_within_plan") {
  Mesh concentric;
  Rng rng = make_rng(403);
  for (int i = 0; i < 10000; ++i) {
    Vec3 p = random_vec3(&rng, 1);
    add_triangle(&concentric, p, -p, {p.x, -p.y, 0});  // the box is that of p and -p
  }
  Mesh same = duplicates("identical", 10000);
  for (const Mesh* mesh : {&same, &concentric}) {
    auto world = make_world(*mesh, &kBvhAccel);
    INFO(mesh->name << ", depth " << depth_of(*world));
    CHECK(depth_of(*world) <= 8);
    CHECK(world->keep.used <= kBvhAccel.need(10000));
    CHECK(world->keep.used_max <= kBvhAccel.need(10000));
    CHECK(world->scratch.used == 0);
    CHECK(is_sound(*world));
  }
  auto world = make_world(same, &kBvhAccel);
  CHECK(closest(*world, {{0, 0, 5}, {0, 0, -1}, kInfinity}).triangle == 0);  // the smallest id of ten thousand equals
  for (const Variant& variant : all_variants())
    for (const Mesh* mesh : {&same, &concentric}) {
      auto other = make_world(*mesh, variant.accel);
      int wrong = wrong_answers(variant, *other, *mesh, gate_share(30, 1000), 404);
      INFO(name_of(variant));
      CHECK(wrong == 0);
      CHECK(other->keep.used_max <= variant.accel->need(10000));
      count_hard(gate_share(30, 1000), wrong, "ends within planned depth and bytes");
    }
}

// Goal: with boxes nested by 2^-i, which drive a greedy tree into depth, the build ends within the plan. Method: all
// powers of two below 1e18 in float, one triangle of each and many of each; ratios nearer one go deeper.
TEST_CASE("hard_15_boxes_nested_by_powers_of_two_end_the_build_within_plan") {
  for (int copies : {1, 4, 40})
    for (float ratio : {0.5f, 0.7f}) {
      Mesh mesh;
      for (float s = 5e17f; s > 1e-36f; s *= ratio)
        for (int i = 0; i < copies; ++i) add_triangle(&mesh, {s, 0, -s}, {0, s, s}, {-s, -s, 0});
      auto world = make_world(mesh, &kBvhAccel);
      INFO(copies << " copies, ratio " << ratio << ", depth " << depth_of(*world));
      CHECK(depth_of(*world) <= kBvhDepthMax);
      CHECK(world->keep.used_max <= kBvhAccel.need(static_cast<std::uint32_t>(mesh.triangles.size())));
      CHECK(is_sound(*world));
      for (const Variant& variant : all_variants()) {
        int rays = gate_share(100, 10000);
        int wrong = wrong_answers(variant, *make_world(mesh, variant.accel), mesh, rays, 405);
        INFO(name_of(variant));
        CHECK(wrong == 0);
        count_hard(rays, wrong, "ends within planned depth and bytes");
      }
    }
}

// Goal: a refitted tree answers like a rebuilt one, and parents contain their children. Method: move the vertices of
// several meshes, slightly and beyond recognition, through NaN and back; compare with brute force and a rebuilt tree.
TEST_CASE("hard_19_refit_after_motion_contains_children_and_hits_as_a_rebuild") {
  for (Mesh start : {jittered_sphere(3, 1, {0, 0, 0}, 0.05f, 43), soup("soup", 500, 1, 0.2f, 44), degenerates()})
    for (const Variant& variant : all_variants()) {
      if (!variant.accel->refit) continue;  // rebuilt instead
      Mesh mesh = start;
      auto world = make_world(mesh, variant.accel);
      Rng rng = make_rng(406);
      for (float motion : {0.0f, 1e-3f, 0.5f, 1e3f, 1e15f, 0.1f}) {
        for (Vec3& p : mesh.positions) p = p + random_vec3(&rng, motion);
        world->positions[0].x = kNan, world->positions.back().y = kInfinity;
        Array<std::uint8_t> data = {world->keep.base, world->accel.data.count};
        variant.accel->refit(&world->accel, data);
        CHECK(is_finite(world->accel.bounds.low));
        std::copy(mesh.positions.begin(), mesh.positions.end(), world->positions.begin());
        variant.accel->refit(&world->accel, data);
        auto rebuilt = make_world(mesh, variant.accel);
        INFO(mesh.name << ", motion " << motion << ", " << name_of(variant));
        CHECK(contains_children(*world, variant.accel->magic == kBvhAccel.magic ? kBlockLeaves : kCompactLeaves));
        CHECK(is_sound(*world));
        CHECK(world->accel.bounds.low == rebuilt->accel.bounds.low);
        CHECK(world->accel.bounds.high == rebuilt->accel.bounds.high);
        int rays = gate_share(400, 10000), wrong = wrong_answers(variant, *world, mesh, rays, 407);
        wrong += wrong_answers(variant, *rebuilt, mesh, rays / 4, 408);
        CHECK(wrong == 0);
        count_hard(rays + rays / 4, wrong, "the bits of a rebuilt tree");
      }
    }
}
