// Ordinary methods beside ours on equal inputs: HARDCASES rows 1, 2, 3, 5, 12, 13, 30 and 66.
#include "hard/ordinary.h"

#include <doctest/doctest.h>

#include "accel/box_ray.h"
#include "accel/oracle.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace pocketray {
namespace ordinary {
namespace {
#include "hard/woop.h"
}  // namespace
bool woop_as_published(const float* origin, const float* direction, const float* a, const float* b, const float* c) {
  return woop(origin, direction, a, b, c);
}
}  // namespace ordinary
}  // namespace pocketray

namespace {

// A ray and the triangles that it is tested against.
struct Shot {
  const Mesh* mesh;
  Ray ray;
};

template <class Test>
bool hits_any(const Mesh& mesh, const Test& test) {
  for (const Triangle& t : mesh.triangles)
    if (test(mesh.positions[t.vertex(0)], mesh.positions[t.vertex(1)], mesh.positions[t.vertex(2)])) return true;
  return false;
}

bool hits_by_ours(const Shot& shot) {
  ShearedRay sheared;
  Hit hit;
  return make_sheared_ray(shot.ray, &sheared) && hits_any(*shot.mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
           return intersect_triangle(sheared, a, b, c, &hit) && hit.t > 0;
         });
}

bool hits_by_moeller_trumbore(const Shot& shot) {
  float t;
  return hits_any(*shot.mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return ordinary::moeller_trumbore(shot.ray, a, b, c, &t);
  });
}

bool hits_by_woop(const Shot& shot) {
  return hits_any(*shot.mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return ordinary::woop_as_published(&shot.ray.origin.x, &shot.ray.direction.x, &a.x, &b.x, &c.x);
  });
}

bool hits_by_contracted_woop(const Shot& shot) {
  return hits_any(*shot.mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return ordinary::woop_contracted(&shot.ray.origin.x, &shot.ray.direction.x, &a.x, &b.x, &c.x);
  });
}

// Answers by ours and by the triangle tests; every shot must hit, or none. Returns the wrong answers of each.
struct WrongAnswers {
  std::uint64_t ours, moeller_trumbore, contracted;
};
WrongAnswers count_triangle_tests(const std::vector<Shot>& shots, bool must_hit, const char* answer,
                                  const char* bound) {
  auto is_wrong = [&](const Shot&, bool hit) { return hit != must_hit; };
  const Answers ours = time_answers(shots, hits_by_ours, is_wrong);
  const Answers first = time_answers(shots, hits_by_moeller_trumbore, is_wrong);
  count_beside("Möller–Trumbore", answer, shots.size(), first, ours);
  count_beside("Woop et al.", answer, shots.size(), time_answers(shots, hits_by_woop, is_wrong), ours);
  Answers contracted;
  if (ordinary::has_contraction()) {
    contracted = time_answers(shots, hits_by_contracted_woop, is_wrong);
    count_beside("Woop et al., contracted", answer, shots.size(), contracted, ours);
  }
  count_hard(shots.size(), ours.wrong, bound);
  return {ours.wrong, first.wrong, contracted.wrong};
}

// Rays from inside a closed mesh at points of its edges, or at its vertices.
std::vector<Shot> aimed_shots(const Mesh& mesh, const Vec3& center, float radius, bool corners, int count, Rng* rng) {
  std::vector<Shot> shots;
  for (int i = 0; i < count; ++i) {
    const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
    const int side = static_cast<int>(next_u32(rng) % 3);
    const Vec3 a = mesh.positions[t.vertex(side)], b = mesh.positions[t.vertex((side + 1) % 3)];
    const Vec3 origin = center + random_vec3(rng, 0.5f * radius);
    shots.push_back({&mesh, {origin, (corners ? a : a + (b - a) * next_float(rng)) - origin, kInfinity}});
  }
  return shots;
}

}  // namespace

// Goal: rays at edges of a closed mesh hit it, which ordinary tests miss. Method: from inside a sphere at the origin
// and far from it, whose coordinates then have few digits left.
TEST_CASE("hard_01_edges_by_ordinary_triangle_tests") {
  WrongAnswers sum = {};
  Rng rng = make_rng(101);
  for (float far : {0.0f, 1.0f, 1e3f, 1e5f}) {
    const Vec3 center = {far, -0.7f * far, 0.3f * far};
    const Mesh mesh = jittered_sphere(2, 1, center, 0.05f, 21);
    const WrongAnswers wrong = count_triangle_tests(aimed_shots(mesh, center, 1, false, gate_share(5000, 100000), &rng),
                                                    true, "ray against up to 320 triangles", "0 misses");
    CHECK(wrong.ours == 0);
    sum.moeller_trumbore += wrong.moeller_trumbore, sum.contracted += wrong.contracted;
  }
  CHECK(sum.moeller_trumbore > 0);                                                    // the inputs are hard
  if (ordinary::has_contraction() && kEffortDivisor == 1) CHECK(sum.contracted > 0);  // rare: one ray in 300
}

TEST_CASE("hard_02_vertices_by_ordinary_triangle_tests") {
  Rng rng = make_rng(102);
  std::uint64_t leaks = 0;
  for (float far : {0.0f, 1e3f}) {
    const Vec3 center = {far, -0.7f * far, 0.3f * far};
    const Mesh mesh = jittered_sphere(2, 1, center, 0.05f, 22);
    const WrongAnswers wrong = count_triangle_tests(aimed_shots(mesh, center, 1, true, gate_share(5000, 100000), &rng),
                                                    true, "ray against up to 320 triangles", "0 misses");
    CHECK(wrong.ours == 0);
    leaks += wrong.moeller_trumbore;
  }
  CHECK(leaks > 0);
}

// Goal: small triangles are hit. Method: legs of 2e-4 to 1e-15, rays at the centroid from a distance in proportion.
TEST_CASE("hard_03_tiny_triangles_by_ordinary_triangle_tests") {
  Rng rng = make_rng(103);
  std::vector<Mesh> meshes;
  for (float leg = 2e-4f; leg >= 1e-15f; leg *= 0.37f)
    for (int i = 0; i < gate_share(100, 3000); ++i) {
      const Vec3 a = random_vec3(&rng, leg);
      meshes.emplace_back();
      add_triangle(&meshes.back(), a, a + Vec3{leg, 0, leg * next_float(&rng)}, a + Vec3{0, leg, -leg});
    }
  std::vector<Shot> shots;
  for (const Mesh& m : meshes) {
    const Vec3 a = m.positions[0], b = m.positions[1], c = m.positions[2];
    const Vec3 centroid = a * (1.0f / 3) + b * (1.0f / 3) + c * (1.0f / 3);
    const Vec3 origin = centroid + random_vec3(&rng, 1000 * length(b - a));
    const Ray ray = {origin, centroid - origin, kInfinity};
    if (oracle_triangle(ray, a, b, c, 4).verdict == Verdict::hit) shots.push_back({&m, ray});
  }
  const WrongAnswers wrong = count_triangle_tests(shots, true, "ray against a triangle", "hit");
  CHECK(wrong.ours == 0);
  CHECK(wrong.moeller_trumbore > 0);
}

// Goal: slivers of 1:10^6 are hit where exact arithmetic says so, and not where it says not. Method: the double oracle
// with a band of 4 ulp; rays at the sliver and beside it.
TEST_CASE("hard_05_slivers_by_ordinary_triangle_tests") {
  Rng rng = make_rng(105);
  std::vector<Mesh> meshes(static_cast<std::size_t>(gate_share(30000, 300000)));
  std::vector<Shot> inside, outside;
  for (Mesh& m : meshes) {
    const Vec3 a = random_vec3(&rng, 1), q = random_vec3(&rng, 1), r = normalize(cross(q, random_vec3(&rng, 1)));
    add_triangle(&m, a, a + q, a + q * 0.4f + r * (length(q) * 1e-6f));
    const Vec3 target = a + q * between(&rng, 0.1f, 0.9f) + r * between(&rng, -2e-6f, 3e-6f);
    const Vec3 origin = target + random_vec3(&rng, 0.05f);
    const Ray ray = {origin, target - origin, kInfinity};
    const OracleHit known = oracle_triangle(ray, m.positions[0], m.positions[1], m.positions[2], 4);
    if (known.verdict == Verdict::hit && known.t - known.t_error > 0) inside.push_back({&m, ray});
    if (known.verdict == Verdict::miss) outside.push_back({&m, ray});
  }
  CHECK(count_triangle_tests(inside, true, "ray against a triangle", "as double says outside 4 ulp").ours == 0);
  CHECK(count_triangle_tests(outside, false, "ray against a triangle", "as double says outside 4 ulp").ours == 0);
}

// Goal: a ray that begins on a triangle's plane does not hit it. Method: points of one lattice plane, coplanar exactly.
TEST_CASE("hard_66_rays_on_a_plane_by_ordinary_triangle_tests") {
  Rng rng = make_rng(166);
  std::vector<Mesh> meshes(static_cast<std::size_t>(gate_share(20000, 300000)));
  std::vector<Shot> shots;
  for (Mesh& m : meshes) {
    auto whole = [&](int size) {
      const int count = 2 * size + 1;
      return static_cast<float>(static_cast<int>(next_u32(&rng) % static_cast<unsigned>(count)) - size);
    };
    const Vec3 along = {whole(6), whole(6), whole(6)}, across = {whole(6), whole(6), whole(6)};
    const Vec3 eye = {whole(1000), whole(1000), whole(1000)};
    auto at = [&](float i, float k) { return eye + along * i + across * k; };
    add_triangle(&m, at(-7, -5), at(11, -4), at(1, 9));
    if (!is_zero(cross(along, across))) shots.push_back({&m, {eye, random_vec3(&rng, 1), kInfinity}});
  }
  CHECK(count_triangle_tests(shots, false, "ray against a triangle", "no hit").ours == 0);
}

namespace {

struct BoxShot {
  Ray ray;
  Vec3 low, high;
};

// As our traversals test a node, here with one child.
bool enters_by_ours(const BoxShot& shot) {
  BvhNode node = {};
  for (int axis = 0; axis < 3; ++axis)
    for (int lane = 0; lane < 4; ++lane)
      node.bounds[axis][lane] = shot.low[axis], node.bounds[axis + 3][lane] = shot.high[axis];
  BoxRay box;
  make_box_ray(Float4::load3(&shot.ray.origin.x), Float4::load3(&shot.ray.direction.x), Float4::load3(&shot.low.x),
               Float4::load3(&shot.high.x), &box);
  Float4 enter;
  return !(bits(miss_boxes(box, node, Float4::splat(shot.ray.t_max), &enter)) & 1);
}

bool enters_by_slabs(const BoxShot& shot) { return ordinary::slabs(shot.ray, shot.low, shot.high); }

void count_box_tests(const std::vector<BoxShot>& shots) {
  auto is_wrong = [](const BoxShot&, bool enters) { return !enters; };
  const Answers ours = time_answers(shots, enters_by_ours, is_wrong),
                unpadded = time_answers(shots, enters_by_slabs, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(unpadded.wrong > 0);
  CHECK(shots.size() > 1000);
  count_beside("slabs, not padded", "ray against a box", shots.size(), unpadded, ours);
  count_hard(shots.size(), ours.wrong, "the box is entered");
}

}  // namespace

// Goal: rays in the faces of a box enter it, though slabs give 0·∞ there. Method: integral boxes, origins and
// directions, for which the closed box is known exactly.
TEST_CASE("hard_12_rays_in_faces_by_an_ordinary_slab_test") {
  std::vector<BoxShot> shots;
  for (int size = 1; size <= gate_share(4, 60); ++size)
    for (int i = 0; i < 27 * 512; ++i) {
      const float unit = static_cast<float>(size), high = 3 * unit;
      const Vec3 origin = Vec3{float(i / 27 % 8 - 2), float(i / 27 / 8 % 8 - 2), float(i / 27 / 64 - 2)} * unit;
      const Vec3 direction = {float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 % 3 - 1)};
      float enter = 0, leave = kInfinity;
      for (int axis = 0; axis < 3; ++axis) {
        const float near = -origin[axis] * direction[axis], far = (high - origin[axis]) * direction[axis];
        if (direction[axis] != 0)
          enter = std::fmax(enter, std::fmin(near, far)), leave = std::fmin(leave, std::fmax(near, far));
        else if (origin[axis] < 0 || origin[axis] > high)
          leave = -1;
      }
      if (enter <= leave && leave > 0 && !is_zero(direction))
        shots.push_back({{origin, direction, kInfinity}, {0, 0, 0}, {high, high, high}});
    }
  count_box_tests(shots);
}

// Goal: a box is entered wherever its triangle is hit. Method: rays at edges and vertices of triangles near and far,
// whose boxes fit tightly; also flat ones.
TEST_CASE("hard_13_tight_boxes_by_an_ordinary_slab_test") {
  Rng rng = make_rng(113);
  std::vector<BoxShot> shots;
  for (int i = 0; i < gate_share(100000, 2000000); ++i) {
    const float far = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : 1e3f;
    Vec3 corner[3];
    const Vec3 center = {far, -0.7f * far, 0.3f * far};
    for (Vec3& v : corner) v = center + random_vec3(&rng, 1);
    if (i % 5 == 0) corner[0].y = corner[1].y = corner[2].y;
    const Vec3 target = i % 2 ? corner[0] : corner[0] + (corner[1] - corner[0]) * next_float(&rng);
    const Vec3 origin = target + random_vec3(&rng, 5);
    const Ray ray = {origin, target - origin, kInfinity};
    ShearedRay sheared;
    Hit hit;
    if (is_zero(ray.direction) || !make_sheared_ray(ray, &sheared)) continue;
    if (!intersect_triangle(sheared, corner[0], corner[1], corner[2], &hit) || !(hit.t > 0)) continue;
    Box box = empty_box();
    for (const Vec3& v : corner) box = merge(box, v);
    shots.push_back({ray, box.low, box.high});
  }
  count_box_tests(shots);
}

// Goal: a vector of any magnitude is normalised. Method: lengths of 2^±140, against its square root's.
TEST_CASE("hard_30_magnitudes_by_an_ordinary_normalization") {
  Rng rng = make_rng(130);
  std::vector<Vec3> vectors;
  for (int i = 0; i < gate_share(20000, 1000000); ++i)
    vectors.push_back(random_vec3(&rng, 1) * std::ldexp(1.0f, i % 221 - 110));
  auto is_wrong = [](const Vec3&, const Vec3& unit) { return !(std::fabs(length(to_double(unit)) - 1) < 1e-6); };
  const Answers ours = time_answers(
      vectors, [](const Vec3& v) { return normalize(v); }, is_wrong);
  const Answers plain = time_answers(
      vectors, [](const Vec3& v) { return v / std::sqrt(dot(v, v)); }, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(plain.wrong > 0);
  count_beside("v / √(v·v)", "vector", vectors.size(), plain, ours);
  count_hard(vectors.size(), ours.wrong, "length 1 within 1e-6");
}
