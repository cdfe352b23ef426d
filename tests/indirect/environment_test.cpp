// Looking up an environment.
#include "indirect/environment.h"

#include <doctest/doctest.h>

#include "base/rng.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

Vec3 random_direction(Rng* rng) {
  auto one = [rng] { return static_cast<float>(2 * next_double(rng) - 1); };
  return normalize(Vec3{one(), one(), one()});
}

}  // namespace

// Goal: an even environment looks the same everywhere, exactly: in each map, between levels and to diffuse surfaces.
TEST_CASE("environment_even_is_even") {
  const TestEnvironment even = even_environment({1, 0.5f, 2});
  Scene scene;
  even.give(&scene);
  Rng rng = make_rng(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 d = random_direction(&rng);
    const float alpha = static_cast<float>(next_double(&rng));
    for (const Vec3& found : {environment_radiance(scene, d), environment_gloss(scene, d, alpha)})
      for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(even.info.radiance_max[c]).epsilon(2e-7));
    CHECK(environment_irradiance(even.info, d) == even.info.irradiance[0]);
  }
}

// Goal: the filter is continuous, over edges and corners of the square, too, and stays within the bound. Method: a map
// of random texels; steps of 10⁻⁴ between directions, at the edges' planes x = 0, z = 0 and around −Y.
TEST_CASE("environment_filter_is_continuous_across_edges") {
  Rng rng = make_rng(4);
  const TestEnvironment noisy(16, 8, {1, 1, 1}, [&](const Vec3d&, int) {
    return Vec3d{next_double(&rng), next_double(&rng), next_double(&rng)};
  });
  Scene scene;
  noisy.give(&scene);
  float most = 0;
  for (int i = 0; i < 30000; ++i) {
    Vec3 d = random_direction(&rng);
    if (i % 4 == 1) d.x *= 1e-4f;
    if (i % 4 == 2) d.z *= 1e-4f, d.y = -d.y;
    if (i % 4 == 3) d = Vec3{d.x * 1e-4f, -1, d.z * 1e-4f};
    d = normalize(d);
    const Vec3 near = d + random_direction(&rng) * 1e-4f;
    const float alpha = static_cast<float>(next_double(&rng));
    const Vec3 a = environment_radiance(scene, d), b = environment_radiance(scene, near);
    const Vec3 c = environment_gloss(scene, d, alpha), e = environment_gloss(scene, near, alpha + 1e-5f);
    most = std::fmax(most, max_component(max(abs(a - b), abs(c - e))));
    CHECK(max_component(max(a, c)) <= max_component(noisy.info.radiance_max) * 1.00001f);
  }
  // A texel is 2/16 wide on the square, on which directions move at most √3 · √3 times as fast.
  CHECK(most < 3 * 1e-4f * 16);
  CHECK(most > 0);
}

// Goal: texel centres look like their texels, and roughness selects levels. Method: texels that name themselves; at
// each stored roughness the gloss is that level's, halfway between the mean.
TEST_CASE("environment_look_up_meets_texels_and_levels") {
  const TestEnvironment named(8, 8, {1, 1, 1}, [](const Vec3d& d, int level) {
    return level < 0 ? Vec3d{d.x + 1, d.y + 1, d.z + 1} : Vec3d{1.0 * level, 0, 0};
  });
  Scene scene;
  named.give(&scene);
  for (int i = 0; i < 64; ++i) {
    const Vec3d p = from_octahedral(2 * (i % 8 + 0.5) / 8 - 1, 2 * (i / 8 + 0.5) / 8 - 1);
    const Vec3 found = environment_radiance(scene, {float(p.x), float(p.y), float(p.z)});
    const Vec3 texel = environment_texel(named.texels[static_cast<std::size_t>(i)]);
    for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(texel[c]).epsilon(1e-5));
  }
  for (int level = 0; level < kGlossLevelCount; ++level) {
    const float r = kGlossRoughness[level];
    CHECK(environment_gloss(scene, {0, 1, 0}, r * r).x == doctest::Approx(level).epsilon(1e-5));
    if (level + 1 == kGlossLevelCount) continue;
    const float between = 0.5f * (r + kGlossRoughness[level + 1]);
    CHECK(environment_gloss(scene, {0, 1, 0}, between * between).x == doctest::Approx(level + 0.5).epsilon(1e-5));
  }
  CHECK(environment_gloss(scene, {0, 1, 0}, 0).x == 0);
}

// Goal: irradiance that rings below zero or above the brightest light is cut there.
TEST_CASE("environment_irradiance_stays_between_darkness_and_the_brightest") {
  EnvironmentInfo info;
  for (Vec3& coefficient : info.irradiance) coefficient = {0, 0, 0};
  info.irradiance[2] = {1, 1, 1}, info.radiance_max = {0.5f, 0.5f, 2};
  CHECK(environment_irradiance(info, Vec3{0, 1, 0}) == Vec3{0.5f, 0.5f, 1});
  CHECK(is_zero(environment_irradiance(info, Vec3{0, -1, 0})));
}
