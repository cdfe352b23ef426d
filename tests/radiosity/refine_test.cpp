// Patches where light is uneven or hidden.
#include "desktop/radiosity/refine.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "radiosity/loose.h"

using namespace pocketray;

namespace {

constexpr float kHalf = 4;  // side of the floor

Loose floor_with_light(float height) {
  Loose scene;
  scene.materials.resize(1);
  scene.materials[0].diffuse = {.5f, .5f, .5f};
  scene.lights.resize(1);
  scene.lights[0].position = {0, 0, height}, scene.lights[0].intensity = {1, 1, 1};
  scene.add({-kHalf, -kHalf, 0}, {kHalf, -kHalf, 0}, {kHalf, kHalf, 0});
  scene.add({-kHalf, -kHalf, 0}, {kHalf, kHalf, 0}, {-kHalf, kHalf, 0});
  return scene;
}

double total_area(const std::vector<Patch>& patches) {
  double area = 0;
  for (const Patch& patch : patches) area += patch.area;
  return area;
}

}  // namespace

// Goal: patches under a light close to them are divided until the light on them is known: what arrives is the
// intensity times the solid angle of the floor, 4·atan(s²/(h·√(2s² + h²))). Others are not, and their number is kept.
TEST_CASE("patches_beside_a_light_are_divided") {
  constexpr double height = .1, s = static_cast<double>(kHalf);
  Loose loose = floor_with_light(static_cast<float>(height));
  const Scene& scene = loose.bind();
  auto test = solving_renderer(scene);
  const SceneRays rays = {test->renderer.frame};
  const Surfaces surfaces = find_surfaces(scene, 25);  // the light is above the middle of one
  const std::vector<Patch> coarse = make_patches(scene, surfaces);
  REQUIRE(coarse.size() == 25);
  const double solid_angle = 4 * std::atan(s * s / (height * std::sqrt(2 * s * s + height * height)));
  auto error = [&](const std::vector<Patch>& patches) {
    double power = 0;
    for (const Patch& patch : patches) power += mean_light(rays, patch).x * patch.area;
    return std::fabs(power / solid_angle - 1);
  };
  std::vector<Patch> fine = coarse;
  refine_patches(rays, surfaces, 1000, 2, &fine);
  MESSAGE("error ", error(coarse), " in 25 patches, ", error(fine), " in ", fine.size());
  CHECK(error(fine) < .01);
  CHECK(error(coarse) > .1);
  CHECK(std::fabs(total_area(fine) / total_area(coarse) - 1) < 1e-6);
  double least = 1e9, most = 0;
  for (const Patch& patch : fine) least = std::min(least, patch.area), most = std::max(most, patch.area);
  CHECK(std::fabs(least * std::pow(4.0, kRefinements) / total_area(coarse) * 25 - 1) < 1e-6);
  CHECK(most > 2 * least);
  for (std::uint32_t limit : {25u, 40u}) {
    std::vector<Patch> few = coarse;
    refine_patches(rays, surfaces, limit, 2, &few);
    CHECK((few.size() <= limit && few.size() + 3 > limit));
  }
}

// Goal: the part of a floor under a box is not part of its patches. Method: a box with no bottom; areas and form
// factors in closed form, and no sample under it.
TEST_CASE("floors_under_boxes_are_left_out") {
  Loose loose = floor_with_light(3);
  loose.materials[0].double_sided = 0;
  const float x0 = -1.3f, x1 = 1.1f;
  const Vec3 base[4] = {{x0, x0, 0}, {x1, x0, 0}, {x1, x1, 0}, {x0, x1, 0}}, up = {0, 0, .5f};
  for (int k = 0; k < 4; ++k) {
    const Vec3 &a = base[k], &b = base[(k + 1) % 4];
    loose.add(a, b, b + up), loose.add(a, b + up, a + up);
  }
  loose.add(base[0] + up, base[1] + up, base[2] + up), loose.add(base[0] + up, base[2] + up, base[3] + up);
  const Scene& scene = loose.bind();
  auto test = solving_renderer(scene);
  std::vector<Patch> patches = make_patches(scene, find_surfaces(scene, 60));
  const double before = total_area(patches);
  uncover_patches({test->renderer.frame}, 2, &patches);
  const double covered = static_cast<double>((x1 - x0) * (x1 - x0));
  CHECK(std::fabs(before - total_area(patches) - covered) < .06 * covered);
  // Seen from above, patches count with the area that is left: from far, and from close by, where their polygons count.
  const Vec3d down = {0, 0, -1}, close = {1.1, 0, .8};
  const double side = static_cast<double>(kHalf), low = static_cast<double>(x0), high = static_cast<double>(x1);
  auto square = [](double a, double b) { return Polygon{{a, a, 0}, {b, a, 0}, {b, b, 0}, {a, b, 0}}; };
  const double close_wanted =
      point_form_factor(close, down, square(-side, side)) - point_form_factor(close, down, square(low, high));
  double factor = 0, close_factor = 0;
  for (const Patch& patch : patches) {
    if (patch.centre.z > 1e-3) continue;
    for (const PatchSample& sample : patch.samples) {
      const double x = sample.point.x, y = sample.point.y;
      CHECK_FALSE((x > low && x < high && y > low && y < high));
    }
    factor += patch_form_factor({0, 0, 40}, down, patch), close_factor += patch_form_factor(close, down, patch);
  }
  const double wanted = (4 * side * side - covered) / (kPi * 1600);
  CHECK(std::fabs(factor / wanted - 1) < .03);
  MESSAGE("from close by ", close_factor, ", by closed form ", close_wanted);
  CHECK(std::fabs(close_factor / close_wanted - 1) < .1);
}
