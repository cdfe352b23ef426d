// Phong's lobe in the mean.
#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "brdf/brdf_list.h"

using namespace pocketray;

// Goal: the mean albedo of a lobe over viewing directions, as of a convex body seen from anywhere: cos θ has the
// density 2 cos θ. Method: ∫ f cosθ dω over rings of equal cosine-weighted solid angle.
TEST_CASE("phong_albedo_is_two_thirds_in_the_mean") {
  constexpr int kViews = 8, kRings = 200, kAround = 200;
  for (float exponent : {20.f, 60.f, 200.f}) {
    Material m;
    m.specular = {.9f, .9f, .9f}, m.exponent = exponent;
    LobeFrame frame;
    frame.normal = {0, 0, 1}, frame.grain = {0, 0, 0};
    double mean = 0;
    for (int view = 0; view < kViews; ++view) {
      const double square = (view + .5) / kViews;
      const Vec3 to_viewer = {float(std::sqrt(1 - square)), 0, float(std::sqrt(square))};
      for (int i = 0; i < kRings * kAround; ++i) {
        const double out = (i / kAround + .5) / kRings, angle = 2 * kPi * (i % kAround + .5) / kAround;
        const Vec3 to_light = {float(std::sqrt(out) * std::cos(angle)), float(std::sqrt(out) * std::sin(angle)),
                               float(std::sqrt(1 - out))};
        mean += double(kPhongBrdf.value(m, m.specular, {0, 0, 0}, frame, to_viewer, to_light).x) * kPi /
                (kRings * kAround * kViews);
      }
    }
    CHECK(std::fabs(mean / .9 - double(kPhongAlbedo)) < .03);
  }
}
