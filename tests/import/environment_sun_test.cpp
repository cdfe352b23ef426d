// The sun of a picture.
#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "desktop/import/environment.h"
#include "desktop/import/environment_sun.h"
#include "indirect/environment.h"

using namespace pocketray;

namespace {

const Vec3d kMiddle = normalize(Vec3d{-2, 3, 1});

// An even sky with a disc of light, edges softened over a tenth of its radius, and a halo.
Vec3d sunny(const Vec3d& d, double radius, double light) {
  const double angle = det_acos(std::fmin(dot(d, kMiddle), 1));
  const double inside = std::fmin(std::fmax((radius - angle) / (0.1 * radius) + 0.5, 0), 1);
  return Vec3d{0.5, 0.6, 0.8} * (1 + 0.3 * det_exp(-angle * 6)) + Vec3d{1, 0.9, 0.7} * (light * inside);
}

// Irradiance on a surface of normal n by what a function of direction has more than another.
Vec3d irradiance(const Vec3d& n, double radius, double light) {
  constexpr int kSide = 1200;
  Vec3d sum = {0, 0, 0};
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec3d p = from_octahedral(2 * (i % kSide + 0.5) / kSide - 1, 2 * (i / kSide + 0.5) / kSide - 1);
    const double square = dot(p, p), cosine = dot(p, n) / std::sqrt(square);
    if (cosine > 0)
      sum += sunny(normalize(p), radius, light) * (cosine * 4 / (double(kSide) * kSide * square * std::sqrt(square)));
  }
  return sum;
}

}  // namespace

// Goal: a small bright disc becomes a directional light, of its size, in its direction, and the light of a surface is
// that of the picture: what the light brings, the other maps lack. Method: integrals of the picture; the map that rays
// see is unchanged.
TEST_CASE("environment_sun_of_a_picture_becomes_a_light") {
  for (double degrees : {0.5, 1.0, 2.5}) {
    const double radius = radians(degrees), light = 40 / (degrees * degrees) * 50;
    auto radiance = [&](const Vec3d& d) { return sunny(d, radius, light); };
    ImportedEnvironment with, without;
    REQUIRE(make_sunny_environment(256, 4, radiance, &with).ok);
    REQUIRE(make_environment(256, 4, radiance, &without).ok);
    CAPTURE(degrees);
    REQUIRE(with.suns.size() == 1);
    REQUIRE(with.lights.size() == 1);
    CHECK(without.suns.empty());
    const EnvironmentSun& sun = with.suns[0];
    CHECK(with.lights[sun.light].kind == LightKind::directional);
    CHECK(dot(-to_double(with.lights[sun.light].direction), kMiddle) > det_cos(radians(0.1)));
    CHECK(sun.radius == doctest::Approx(radius).epsilon(0.25));
    for (std::size_t i = 0; i < 256 * 256; ++i) CHECK(with.texels[i] == without.texels[i]);
    for (const Vec3d& n : {kMiddle, Vec3d{0, 1, 0}}) {
      const Vec3d all = irradiance(n, radius, light);
      const Vec3d rest = to_double(environment_irradiance(with.info, to_float(n))) * kPi;
      const Vec3d direct = to_double(with.lights[0].intensity) * -dot(to_double(with.lights[0].direction), n);
      // A texel is wider than the smallest disc, and has the mean of 16 points.
      const double tolerance = degrees < 1 ? 0.05 : 0.02;
      for (int c = 0; c < 3; ++c) CHECK(rest[c] + direct[c] == doctest::Approx(all[c]).epsilon(tolerance));
    }
    Scene scene;
    scene.environment_info = {&with.info, 1};
    scene.environment_texels = {with.texels.data(), static_cast<std::uint32_t>(with.texels.size())};
    const Vec3 towards = to_float(kMiddle);
    CHECK(environment_radiance(scene, towards).x > 50);
    CHECK(environment_gloss(scene, towards, 0.01f).x < 1);
  }
}

// Goal: light that is even, smooth, or from a wide source stays in the maps.
TEST_CASE("environment_without_a_sun_has_no_light") {
  for (int variant = 0; variant < 3; ++variant) {
    ImportedEnvironment environment;
    auto radiance = [&](const Vec3d& d) {
      if (variant == 0) return Vec3d{1, 1, 1};
      if (variant == 1) return Vec3d{1 + d.x, 1 + d.y, 1};
      return sunny(d, radians(15), 40);
    };
    REQUIRE(make_sunny_environment(64, 2, radiance, &environment).ok);
    CAPTURE(variant);
    CHECK(environment.lights.empty());
    CHECK(environment.suns.empty());
  }
  ImportedEnvironment black;
  REQUIRE(make_sunny_environment(
              64, 1,
              [](const Vec3d&) {
                return Vec3d{0, 0, 0};
              },
              &black)
              .ok);
  CHECK(black.lights.empty());
}

// Goal: the sky's sun has the disc that is seen from the earth, which the map lacks.
TEST_CASE("environment_sun_of_the_sky_has_a_disc") {
  ImportedEnvironment sky;
  REQUIRE(read_environment("sky:60,3", &sky).ok);
  REQUIRE(sky.suns.size() == 1);
  CHECK(sky.lights.size() == 1);
  CHECK(sky.suns[0].light == 0);
  CHECK(sky.suns[0].radius == doctest::Approx(radians(0.2665)));
  CHECK(sky.suns[0].cos_shown > 1);
}
