// Origins of secondary rays by an ordinary method beside ours: HARDCASES row 20.
#include "shade/shade_helpers.h"
#include "shade/surface.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

struct Leaving {
  Surface surface;
  Vec3 direction;  // into the body
};

// Points of random triangles, away from edges, and directions from there into the body.
std::vector<Leaving> leaving_rays(const FrameData& frame, int count) {
  Rng rng = make_rng(120);
  std::vector<Leaving> list;
  auto any = [&] { return 2 * next_float(&rng) - 1; };
  while (count-- > 0) {
    Hit hit;
    hit.triangle = next_u32(&rng) % frame.scene->triangles.count;
    hit.u = 0.1f + 0.4f * next_float(&rng), hit.v = 0.1f + 0.3f * next_float(&rng);
    Leaving leaving;
    const Vec3 outside = {any(), any(), any()};
    leaving.direction = normalize(Vec3{any(), any(), any()});
    frame.kernels.surface(frame, {{0, 0, 0}, outside, 1}, hit, &leaving.surface);
    if (!leaving.surface.front) continue;
    const float depth = -dot(leaving.direction, leaving.surface.geometric);
    if (depth < 0) leaving.direction = -leaving.direction;
    if (std::fabs(depth) > 0.05f) list.push_back(leaving);
  }
  return list;
}

}  // namespace

// Goal: a ray into a closed body meets another of its triangles, whatever the size of the body and its place. Method:
// spheres of sizes from 10⁻⁸ to 10⁸, at the origin and far from it; the origin moved by us, or by 10⁻⁴ along the
// normal.
TEST_CASE("hard_20_spawned_rays_by_an_ordinary_offset") {
  const struct {
    Vec3 center;
    float radius;
  } kSpheres[] = {
      {{0, 0, 0}, 1}, {{0, 0, 0}, 1e8f}, {{0, 0, 0}, 1e-8f}, {{1e8f, -3e7f, 2e8f}, 1e6f}, {{1000, 0, 0}, 0.5f}};
  std::uint64_t wrong_by_offset = 0;
  for (const auto& sphere : kSpheres) {
    GeneratedScene s;
    add_sphere(&s, sphere.center, sphere.radius, 12, 8, add_material(&s, matte(1)));
    auto t = ray_renderer(&s);
    const Renderer& renderer = t->renderer;
    const std::vector<Leaving> rays = leaving_rays(renderer.frame, gate_share(5000, 200000));
    auto next_triangle = [&](const Vec3& origin, const Leaving& leaving) {
      Hit hit;
      const Ray ray = {origin, leaving.direction, __builtin_inff()};
      renderer.accel.info->closest(renderer.accel.built, ray, nullptr, &hit, nullptr);
      return hit.triangle;
    };
    auto is_wrong = [](const Leaving& leaving, std::uint32_t triangle) {
      return triangle == kNoTriangle || triangle == leaving.surface.hit.triangle;
    };
    auto by_ours = [&](const Leaving& l) { return next_triangle(safe_origin(l.surface, -1), l); };
    auto by_offset = [&](const Leaving& l) { return next_triangle(l.surface.point - l.surface.geometric * 1e-4f, l); };
    const Answers ours = time_answers(rays, by_ours, is_wrong), offset = time_answers(rays, by_offset, is_wrong);
    CAPTURE(sphere.radius);
    CHECK(ours.wrong == 0);
    CHECK(rays.size() > 1000u / kEffortDivisor);
    wrong_by_offset += offset.wrong;
    count_beside("offset of 1e-4", "ray from a surface", rays.size(), offset, ours);
    count_hard(rays.size(), ours.wrong, "another triangle of the body");
  }
  CHECK(wrong_by_offset > 0);
}
