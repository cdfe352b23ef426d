// Every accelerator, with single rays and packets, against brute force, bit for bit, and against the oracle in double.
#include <doctest/doctest.h>

#include "accel/oracle.h"
#include "accel/variant.h"
#include "support/effort.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// Rejects a third of the triangles and a part of each other one.
bool accept_some(const void*, std::uint32_t triangle, float u, float v) { return triangle % 3 != 0 && u <= v + 0.25f; }
constexpr HitFilter kSome = {accept_some, nullptr};

// A filter, if any, that rejects two triangles, too.
struct Without {
  const HitFilter* base;
  std::uint32_t first, second;
};
bool accept_without(const void* context, std::uint32_t triangle, float u, float v) {
  const Without& without = *static_cast<const Without*>(context);
  return triangle != without.first && triangle != without.second &&
         (!without.base || without.base->accept(nullptr, triangle, u, v));
}

// Rays that share an origin and t_max, and the answers of brute force: closest hits, and whether a ray that joins the
// first triangle it hits and the next one is blocked all the same, by any and by some.
struct Group {
  std::vector<Ray> rays;
  std::vector<Hit> hits, filtered;
  std::vector<Ray> joining;
  std::vector<bool> blocked, blocked_by_some;
};

void join_hits(const World& oracle, Ray ray, const Hit& hit, Group* group) {
  const Without first = {nullptr, hit.triangle, kNoTriangle};
  const HitFilter beyond_first = {accept_without, &first};
  ray.from = hit.triangle, ray.to = closest(oracle, ray, nullptr, &beyond_first).triangle;
  group->joining.push_back(ray);
  for (const HitFilter* base : {static_cast<const HitFilter*>(nullptr), &kSome}) {
    const Without both = {base, ray.from, ray.to};
    const HitFilter beyond = {accept_without, &both};
    (base ? group->blocked_by_some : group->blocked)
        .push_back(closest(oracle, ray, nullptr, &beyond).triangle != kNoTriangle);
  }
}

// Origins: far outside, inside, within the box of a triangle, at a vertex.
Vec3 random_origin(Rng* rng, const Mesh& mesh, const Vec3& middle, float size) {
  std::uint32_t kind = next_u32(rng) % 8;
  if (kind < 2 || mesh.triangles.empty()) return middle + random_vec3(rng, 2 * size);
  if (kind == 2) return middle + normalize(random_vec3(rng, 1)) * std::fmin(40 * size, 2 * kCoordinateMax);
  if (kind < 5) return middle + random_vec3(rng, 0.6f * size);
  const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
  Vec3 a = mesh.positions[t.vertex(0)], b = mesh.positions[t.vertex(1)], c = mesh.positions[t.vertex(2)];
  return kind < 7 ? min(min(a, b), c) * 0.5f + max(max(a, b), c) * 0.5f : a;
}

// Directions: at edges and corners, random, along axes and diagonals; a few are invalid.
Vec3 random_direction(Rng* rng, const Mesh& mesh, const Vec3& origin, const Vec3& middle, float size) {
  if (next_u32(rng) % 100 == 0) return {0, next_u32(rng) % 2 ? 0 : std::numeric_limits<float>::quiet_NaN(), 0};
  std::uint32_t kind = next_u32(rng) % 8;
  if (kind == 0) {
    Vec3 direction = {0, 0, 0};
    direction[static_cast<int>(next_u32(rng) % 3)] = next_u32(rng) % 2 ? 1.0f : -1.0f;
    if (next_u32(rng) % 4 == 0) direction[static_cast<int>(next_u32(rng) % 3)] = 1;
    return direction;
  }
  if (kind < 3 || mesh.triangles.empty()) return middle + random_vec3(rng, 0.6f * size) - origin;
  const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
  Vec3 a = mesh.positions[t.vertex(0)], b = mesh.positions[t.vertex(1)];
  return (kind < 5 ? a : a + (b - a) * next_float(rng)) - origin;
}

// The rays of a group: scattered, or side by side as in a picture. A quarter of the groups ends early.
std::vector<Ray> random_rays(Rng* rng, const Mesh& mesh, const Box& bounds, int count) {
  Vec3 middle = is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds);
  float size = is_empty(bounds) ? 1.0f : max_component(extent(bounds));
  Vec3 origin = random_origin(rng, mesh, middle, size), common = random_direction(rng, mesh, origin, middle, size);
  float step = max_component(abs(common));
  Vec3 right = random_vec3(rng, 0.02f) * step, up = random_vec3(rng, 0.02f) * step;
  bool side_by_side = next_u32(rng) % 2;
  float t_max = next_u32(rng) % 4 ? kInfinity : 0.9f;
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Vec3 direction = side_by_side ? common + right * static_cast<float>(i % 8) + up * static_cast<float>(i / 8)
                                  : random_direction(rng, mesh, origin, middle, size);
    rays.push_back({origin, direction, t_max});
  }
  return rays;
}

// Ends a group's rays just at, after or before a hit of one of them: t_max is exclusive.
void cut_at_hit(Rng* rng, const World& oracle, std::vector<Ray>* rays) {
  Hit hit = closest(oracle, (*rays)[next_u32(rng) % rays->size()]);
  if (hit.triangle == kNoTriangle) return;
  std::uint32_t kind = next_u32(rng) % 3;
  for (Ray& ray : *rays) ray.t_max = kind == 0 ? hit.t : std::nextafter(hit.t, kind == 1 ? kInfinity : 0.0f);
}

// Groups alternate between kinds; fewer than eight would omit some.
std::vector<Group> random_groups(Rng* rng, const Mesh& mesh, const World& oracle, int count) {
  if (count < 8) count = 8;
  std::vector<Group> groups(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Group& group = groups[static_cast<std::size_t>(i)];
    const int most = kSoftFloats ? kGroupMax / 4 : kGroupMax;
    const int counts[] = {most, kGroupMax, 1 + static_cast<int>(next_u32(rng) % static_cast<unsigned>(most)), 1};
    group.rays = random_rays(rng, mesh, oracle.accel.bounds, counts[i % 4]);
    show_gate_progress(static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(count));
    if (i % 8 >= 5) cut_at_hit(rng, oracle, &group.rays);
    for (const Ray& ray : group.rays) {
      group.hits.push_back(closest(oracle, ray));
      group.filtered.push_back(closest(oracle, ray, nullptr, &kSome));
      join_hits(oracle, ray, group.hits.back(), &group);
    }
  }
  return groups;
}

int wrong_in_group(const Variant& variant, const World& world, const Group& group) {
  int wrong = 0, count = static_cast<int>(group.rays.size());
  Hit hits[kGroupMax], filtered[kGroupMax];
  answer(variant, world, group.rays.data(), count, nullptr, hits);
  answer(variant, world, group.rays.data(), count, &kSome, filtered);
  for (int i = 0; i < count; ++i) {
    const Hit &hit = group.hits[static_cast<std::size_t>(i)], &other = group.filtered[static_cast<std::size_t>(i)];
    const Ray& ray = group.rays[static_cast<std::size_t>(i)];
    bool occluded = world.info->occluded(world.accel, ray, nullptr, nullptr);
    bool occluded_by_some = world.info->occluded(world.accel, ray, &kSome, nullptr);
    wrong += !same_hit(hits[i], hit) || !same_hit(filtered[i], other) || occluded != (hit.triangle != kNoTriangle) ||
             occluded_by_some != (other.triangle != kNoTriangle);
    const std::size_t at = static_cast<std::size_t>(i);
    wrong += world.info->occluded(world.accel, group.joining[at], nullptr, nullptr) != group.blocked[at] ||
             world.info->occluded(world.accel, group.joining[at], &kSome, nullptr) != group.blocked_by_some[at];
  }
  return wrong;
}

}  // namespace

// Goal: the same (t, u, v, id) from every structure, instruction set and packet size, and the same occlusion.
// Method: differential against brute force on meshes of every kind; rays from inside boxes, from outside and afar, at
// corners and edges, along axes, with t_max just at their hits, with and without a filter; and rays that join two of
// the triangles they hit, against closest hits of a filter without these.
TEST_CASE("differential_every_variant_answers_as_brute_force") {
  for (const Mesh& mesh : generated_meshes()) {
    if (kSoftFloats && mesh.triangles.size() > 1000) continue;  // brute force would take minutes
    auto oracle = make_world(mesh, &kBruteAccel);
    Rng rng = make_rng(101);
    std::vector<Group> groups = random_groups(&rng, mesh, *oracle, gate_share(96, 1500));
    for (const Variant& variant : all_variants()) {
      auto world = make_world(mesh, variant.accel);
      std::uint64_t wrong = 0, rays = 0, hits = 0;
      for (const Group& group : groups) {
        wrong += wrong_in_group(variant, *world, group);
        rays += group.rays.size();
        for (const Hit& hit : group.hits) hits += hit.triangle != kNoTriangle;
      }
      INFO(mesh.name << ", " << name_of(variant) << ", " << hits << " hits of " << rays);
      CHECK(wrong == 0);
      if (!mesh.triangles.empty() && groups.size() >= 32) CHECK(hits > rays / 20);
      count_hard(rays, wrong, "the bits of brute force");
    }
  }
}

// Goal: brute force, and thus all others, hit what exact arithmetic hits, outside a band of 4 ulp. Method: the oracle
// in double, which uses another method, on the same meshes and rays; it decides most of them.
TEST_CASE("differential_brute_force_answers_as_double_outside_4_ulp") {
  for (const Mesh& mesh : generated_meshes()) {
    if (mesh.name == "denormal") continue;  // ulps are meaningless there
    auto oracle = make_world(mesh, &kBruteAccel);
    Rng rng = make_rng(102);
    int rays = 0, wrong = 0, decided = 0;
    for (const Group& group : random_groups(&rng, mesh, *oracle, gate_share(24, 300)))
      for (std::size_t i = 0; i < group.rays.size(); ++i, ++rays)
        wrong += !oracle_agrees(*oracle, group.rays[i], group.hits[i], 4, &decided);
    INFO(mesh.name << ": " << decided << " of " << rays << " decided");
    CHECK(wrong == 0);
    if (rays >= 1000) CHECK(decided > rays / 4);
    count_hard(decided, wrong, "t and id of double outside 4 ulp");
  }
}
