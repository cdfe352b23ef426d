// Source selection: how far a picture with few shadow rays may be from one with all of them, and what it costs.
#include <doctest/doctest.h>

#include <cmath>
#include <iterator>

#include "support/effort.h"
#include "support/generated_scene.h"
#include "support/hard_case.h"
#include "support/scaled_scene.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 40, kHeight = 30;

// A generated scene with so many more lights of all kinds, most of them weak or far away, some blocked.
std::unique_ptr<GeneratedScene> lit_scene(std::uint32_t features, std::uint64_t seed, std::uint32_t light_count) {
  auto s = generate_scene(features, seed);
  Rng rng = make_rng(seed, 77);
  for (std::uint32_t i = 0; i < light_count; ++i) {
    Light light;
    const float kind = next_float(&rng);
    light.kind = kind < 0.7f ? LightKind::point : kind < 0.95f ? LightKind::spot : LightKind::directional;
    light.position = {next_float(&rng) * 12 - 6, next_float(&rng) * 5, next_float(&rng) * 12 - 6};
    light.direction = normalize(Vec3{next_float(&rng) - 0.5f, -0.2f - next_float(&rng), next_float(&rng) - 0.5f});
    const float brightness = next_float(&rng),
                strength = brightness * brightness * 20 / static_cast<float>(light_count);
    light.intensity = Vec3{next_float(&rng), next_float(&rng), next_float(&rng)} * strength;
    if (light.kind == LightKind::directional) light.intensity = light.intensity * 0.1f;
    light.cos_inner = 0.9f, light.cos_outer = 0.6f;
    light.range = i % 5 == 0 ? 6 : 0;
    s->lights.push_back(light);
  }
  s->bind();
  return s;
}

Settings settings_of(std::uint32_t features, float tolerance) {
  Settings settings = settings_for(features, kWidth, kHeight);
  settings.points_per_area_light = 9;
  settings.area_shadows = AreaShadows::every;
  settings.cut_off_levels = 0;
  settings.light_tolerance = tolerance;
  return settings;
}

struct Traced {
  Picture picture;
  std::uint64_t shadow_rays;
};

Traced trace(const Scene& scene, const Settings& settings, bool selects) {
  auto test = make_renderer(scene, settings);
  REQUIRE(has(test->renderer.effects.mask, Effect::source_selection) == selects);
  CHECK(test->renderer.lights.nodes.empty() == !selects);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  return {Picture(test->renderer.image.begin(), test->renderer.image.end()),
          total_counts(test->renderer).rays[static_cast<int>(RayKind::shadow)]};
}

// The largest difference of a channel, relative to the reference's brightest channel there.
double largest_error(const Picture& picture, const Picture& reference) {
  REQUIRE(picture.size() == reference.size());
  double largest = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const float error = max_component(abs(picture[i] - reference[i]));
    if (error > 0) largest = std::fmax(largest, double(error) / double(max_component(reference[i])));
  }
  return largest;
}

double total(const Picture& picture) {
  double sum = 0;
  for (const Vec3& p : picture) sum += double(p.x) + double(p.y) + double(p.z);
  return sum;
}

// Surfaces without rays that go on, whose tints could make up for the brightest channel.
constexpr std::uint32_t kDirect = kAllFeatures & ~bit(Feature::mirror) & ~bit(Feature::refraction) &
                                  ~bit(Feature::absorption) & ~bit(Feature::thin) & ~bit(Feature::alpha_blend) &
                                  ~bit(Feature::metallic_roughness);

}  // namespace

// Goal: no pixel errs by more than the tolerance, all of them on average by much less, and a looser one saves rays.
// Method: every pixel against all lights tested, on seeded scenes of diffuse, glossy and textured surfaces.
TEST_CASE("source_selection_errs_within_the_tolerance") {
  for (std::uint64_t seed = 1; seed <= (kEffortDivisor > 1 ? 2 : 6); ++seed)
    for (std::uint32_t features : {kDirect, bit(Feature::ambient), kDirect & ~bit(Feature::ambient)}) {
      auto s = lit_scene(features, seed, 70);
      if (seed % 2 == 0)  // the glossy lobe alone
        for (Material& m : s->materials)
          if (!is_zero(m.specular)) m.diffuse = {0, 0, 0};
      for (Sheen& sheen : s->sheens)  // one colour for light from everywhere and from lights: see kDirect
        if (!is_zero(sheen.color)) sheen.color = {0.7f, 0.7f, 0.7f}, sheen.color_texture = TextureUse();
      s->bind();
      const Traced all = trace(s->scene, settings_of(features, 0), false);
      std::uint64_t more_rays = all.shadow_rays + 1;
      for (float tolerance : {0.01f, 0.1f, 0.5f}) {
        const Traced some = trace(s->scene, settings_of(features, tolerance), true);
        CAPTURE(seed);
        CAPTURE(features);
        CAPTURE(tolerance);
        CHECK(largest_error(some.picture, all.picture) <= double(tolerance) * 1.0001);
        CHECK(std::fabs(total(some.picture) / total(all.picture) - 1) < double(tolerance) / 8);
        CHECK(some.shadow_rays < more_rays);
        more_rays = some.shadow_rays;
      }
      CHECK(more_rays < all.shadow_rays / 3);
    }
}

// Goal: next to no tolerance gives the picture of all lights, whatever effects there are or are forced off. Method:
// relative difference, which is that of sums in another order.
TEST_CASE("source_selection_approaches_all_lights_with_every_effect") {
  auto s = lit_scene(kAllFeatures, 3, 40);
  const Effect off[] = {Effect::supersampling, Effect::shadow,     Effect::specular,          Effect::mirror,
                        Effect::refraction,    Effect::absorption, Effect::back_face_culling, Effect::alpha_blend,
                        Effect::mip_map,       Effect::area_light, Effect::metallic_roughness};
  for (int i = 0; i < effort(static_cast<int>(std::size(off))); ++i) {
    const Effect effect = off[i];
    Settings settings = settings_of(kAllFeatures, 0);
    settings.forced_off = bit(effect);
    const Traced all = trace(s->scene, settings, false);
    settings.light_tolerance = 1e-7f;
    const Traced some = trace(s->scene, settings, true);
    CAPTURE(static_cast<int>(effect));
    CHECK(largest_error(some.picture, all.picture) < 1e-4);
    if (effect == Effect::shadow) CHECK(some.shadow_rays == 0);
  }
}

// Goal: pixels do not depend on how they are traced together, nor on the number of threads. Method: bit for bit, rows
// of single pixels, tiles and threads.
TEST_CASE("source_selection_is_independent_of_tiles_and_threads") {
  auto s = lit_scene(kAllFeatures, 5, 40);
  Settings settings = settings_of(kAllFeatures, 0.1f);
  const Picture expected = trace(s->scene, settings, true).picture;
  settings.threads = 3;
  CHECK(same_picture(trace(s->scene, settings, true).picture, expected));
  settings.threads = 1;
  auto test = make_renderer(s->scene, settings);
  test->renderer.frame.geometry.ray_by_ray = false;
  Tracer tracer = test->renderer.tracers[0];
  Picture single(expected.size());
  for (std::uint16_t row = 0; row < kHeight; ++row)
    for (std::uint16_t column = 0; column < kWidth; ++column) {
      const Span span = {row, column, static_cast<std::uint16_t>(column + 1)};
      trace_spans(&tracer, &span, 1, Aov::none, single.data());
    }
  CHECK(same_picture(single, expected));
}

// Goal: the exposure is measured with the selection, too. Method: a scene that asks for it, against a renderer that has
// rendered its frame.
TEST_CASE("source_selection_serves_the_exposure") {
  auto s = lit_scene(kDirect, 4, 40);
  s->scene.info.auto_exposure = 1;
  auto test = make_renderer(s->scene, settings_of(kDirect, 0.1f));
  REQUIRE(has(test->renderer.effects.mask, Effect::source_selection));
  REQUIRE(render_frame(&test->renderer, 0).ok);
  CHECK(measure_exposure(&test->renderer) == test->renderer.view.exposure);
}

// Goal: a scene scaled by a power of two gives the same picture. Method: bit for bit.
TEST_CASE("source_selection_is_independent_of_scale") {
  auto s = lit_scene(kDirect, 8, 40);
  for (Light& light : s->lights) light.range = 0;
  s->bind();
  const Settings settings = settings_of(kDirect, 0.1f);
  const Picture expected = trace(s->scene, settings, true).picture;
  for (float k : {0x1p-8f, 0x1p10f}) {
    auto scaled = scale_scene(s->scene, k);
    CAPTURE(k);
    CHECK(same_picture(trace(scaled->scene, settings, true).picture, expected));
  }
}

// Goal: the cost grows slower than the number of lights. Method: 25 to 1,600 equal lights, seeded, over a ground that
// grows with their number, as that of a town does; shadow rays, which are counted.
TEST_CASE("hard_75_source_selection_grows_slower_than_the_number_of_lights") {
  count_assertions("shadow rays below proportion, error within tolerance");
  const std::uint32_t features = bit(Feature::ambient);
  std::vector<std::uint64_t> rays;
  for (std::uint32_t count : {25u, 100u, 400u, 1600u}) {
    if (count > 100 && kEffortDivisor > 1) break;
    auto s = generate_scene(features, 2);
    Rng rng = make_rng(count);
    const float side = 2 * std::sqrt(static_cast<float>(count));
    for (std::uint32_t k = 0; k < count; ++k) {
      Light light;
      light.kind = LightKind::point;
      light.position = {(next_float(&rng) - 0.5f) * side, 2 + next_float(&rng), (next_float(&rng) - 0.5f) * side};
      light.intensity = {1, 1, 1};
      s->lights.push_back(light);
    }
    s->bind();
    const Traced all = trace(s->scene, settings_of(features, 0), false);
    const Traced some = trace(s->scene, settings_of(features, 0.1f), true);
    CHECK(largest_error(some.picture, all.picture) <= 0.1);
    MESSAGE(count << " lights: " << some.shadow_rays << " shadow rays of " << all.shadow_rays);
    rays.push_back(some.shadow_rays);
  }
  for (std::size_t i = 1; i < rays.size(); ++i) CHECK(4 * rays[i] < 14 * rays[i - 1]);  // of four times the lights
  if (kEffortDivisor == 1) CHECK(rays.back() < 32 * rays[0]);                           // of 64 times the lights
}
