// Cameras that frame points, at any aspect and field of view.
#include "plan/framing.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/rng.h"
#include "support/picture_bounds.h"

using namespace pocketray;

namespace {

struct Points {
  std::vector<Vec3> all;
  Box bounds = empty_box();
  void add(const Vec3& p) { all.push_back(p), bounds = merge(bounds, p); }
};

// A cloud that is longer along some axes than along others.
Points cloud(std::uint64_t seed) {
  Rng rng = make_rng(seed);
  auto signed_unit = [&] { return 2 * next_float(&rng) - 1; };
  const Vec3 size = {std::exp2(2 * signed_unit()), std::exp2(2 * signed_unit()), std::exp2(2 * signed_unit())};
  const Vec3 place = {100 * signed_unit(), 100 * signed_unit(), 100 * signed_unit()};
  Points points;
  const std::uint32_t count = 1 + next_u32(&rng) % 40;
  for (std::uint32_t i = 0; i <= count; ++i)
    points.add(place + Vec3{signed_unit(), signed_unit(), signed_unit()} * size);
  return points;
}

Camera frame(const Points& points, float aspect, const Vec3& backward, double fov) {
  ReachMeter meter(center(points.bounds), backward);
  for (const Vec3& p : points.all) meter.add(p);
  return framing_camera(meter.framing(), points.bounds, aspect, fov);
}

}  // namespace

// Goal: points fill nine tenths of the picture's width or height, are in its middle, and nothing is cut, whatever its
// aspect and field of view. Method: projections of clouds; the bound between stored angles costs up to 4 %.
TEST_CASE("framing_camera_fills_nine_tenths") {
  const Vec3 backward = normalize(Vec3{0.45f, 0.35f, 1.0f});
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    for (float aspect : {0.75f, 1.0f, 4.0f / 3, 2.4f})
      for (double degrees : {1.0, 20.0, 40.0, 60.0}) {
        CAPTURE(seed);
        CAPTURE(aspect);
        CAPTURE(degrees);
        const Points points = cloud(seed);
        const Camera camera = frame(points, aspect, backward, radians(degrees));
        CHECK(dot(normalize(camera.eye - camera.target), backward) > 0.9999f);
        const PictureBounds seen = picture_bounds(camera, aspect, points.all);
        REQUIRE(seen.in_front);
        CHECK(seen.fill() < 0.902f);
        CHECK(seen.fill() > 0.86f);
        CHECK(std::fabs(seen.left + seen.right) < 0.08f);
        CHECK(std::fabs(seen.bottom + seen.top) < 0.08f);
      }
}

// Goal: extreme fields of view keep everything in front of the eye and in the picture. Method: as above, and a line
// along the view axis, which fits at any distance.
TEST_CASE("framing_camera_keeps_points_in_front_of_the_eye") {
  const Vec3 backward = {0, 0, 1};
  Points line;
  line.add({1, 2, -8}), line.add({1, 2, 8});
  for (double degrees : {0.01, 40.0, 120.0, 175.0}) {
    CAPTURE(degrees);
    for (const Points& points : {line, cloud(3), cloud(4)}) {
      const PictureBounds seen = picture_bounds(frame(points, 1.5f, backward, radians(degrees)), 1.5f, points.all);
      CHECK(seen.in_front);
      CHECK(seen.fill() < 0.902f);
    }
  }
}
