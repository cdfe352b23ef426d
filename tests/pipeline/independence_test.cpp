#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "engine/prepare.h"
#include "engine/progressive.h"
#include "scene/baked.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kRich = kAllFeatures;

// Which pixels are traced, the others being interpolated between them; or samples added to some.
struct Traced {
  float contrast = 0;
  Resolution resolution = Resolution::full;
  std::uint32_t edge_samples = 0;
};
constexpr Traced kAll = {};
constexpr Traced kSome[] = {
    {0.25f, Resolution::full}, {0, Resolution::checkerboard}, {0.25f, Resolution::half}, {0, Resolution::full, 5}};
constexpr Traced kAllOrSome[] = {kAll, kSome[0], kSome[1], kSome[2], kSome[3]};

Settings small_settings(const Traced& traced = kAll) {
  Settings settings = settings_for(kRich, 45, 34);
  settings.selective_contrast = traced.contrast, settings.resolution = traced.resolution;
  settings.edge_samples = traced.edge_samples;
  if (traced.edge_samples > 0) settings.samples_per_pixel = 1;  // others take none at edges
  return settings;
}

bool same_image(const Array<Vec3>& image, const Picture& picture) {
  return image.count == picture.size() && std::memcmp(image.data, picture.data(), image.bytes()) == 0;
}

void shuffle(Rng* rng, std::vector<Span>* spans) {
  for (std::size_t i = spans->size(); i > 1; --i) std::swap((*spans)[i - 1], (*spans)[next_u32(rng) % i]);
}

}  // namespace

// Goal: the suites use valid scenes. Method: every generated scene passes the checks of a loader.
TEST_CASE("generated_scenes_are_valid") {
  for (std::uint32_t features : feature_sets()) {
    auto generated = generate_scene(features, features);
    Status status = validate_scene(generated->scene);
    CAPTURE(std::string(status.message));
    REQUIRE(status.ok);
  }
}

// Goal: the picture does not depend on the number of threads. Method: differential, including the ray counts.
TEST_CASE("picture_is_independent_of_threads") {
  auto generated = generate_scene(kRich, 5);
  Settings settings = small_settings();
  auto one = make_renderer(generated->scene, settings);
  REQUIRE(render_frame(&one->renderer, 0.4).ok);
  Picture expected(one->renderer.image.begin(), one->renderer.image.end());
  Tracer counts = total_counts(one->renderer);
  for (std::uint32_t threads : {2u, 3u, 7u}) {
    settings.threads = threads;
    auto test = make_renderer(generated->scene, settings);
    CAPTURE(threads);
    for (int repeat = 0; repeat < 5; ++repeat) {
      REQUIRE(render_frame(&test->renderer, 0.4).ok);
      CHECK(same_image(test->renderer.image, expected));
      Tracer total = total_counts(test->renderer);
      CHECK(std::memcmp(total.rays, counts.rays, sizeof counts.rays) == 0);
      CHECK(total.rays_left_out == counts.rays_left_out);
      CHECK(total.left_out_max == counts.left_out_max);
      CHECK(total.left_out_share_max == counts.left_out_share_max);
      CHECK(total.ended_bound_max == counts.ended_bound_max);
    }
  }
}

// Goal: the same where threads keep traced pixels for the rows below; only the number of rays depends on them.
TEST_CASE("picture_with_interpolated_pixels_is_independent_of_threads") {
  // The textures of leaves would leave nothing to interpolate.
  auto generated = generate_scene(kRich & ~bit(Feature::diffuse_transmission), 5);
  for (const Traced& traced : kSome) {
    const Picture expected = render_picture(generated->scene, small_settings(traced), 0.4);
    CHECK(!same_picture(expected, render_picture(generated->scene, small_settings(), 0.4)));
    for (std::uint32_t threads : {2u, 7u}) {
      Settings settings = small_settings(traced);
      settings.threads = threads;
      CAPTURE(threads);
      for (int repeat = 0; repeat < 2; ++repeat)
        CHECK(same_picture(render_picture(generated->scene, settings, 0.4), expected));
    }
  }
}

// Goal: the picture does not depend on how a frame is divided into spans, nor on their order: threads, servers and
// temporal coherence rely on that. Method: differential, shuffled pieces of random length by one tracer.
TEST_CASE("picture_is_independent_of_spans") {
  auto generated = generate_scene(kRich, 6);
  for (const Traced& traced : kAllOrSome) {
    auto test = make_renderer(generated->scene, small_settings(traced));
    Renderer& renderer = test->renderer;
    REQUIRE(render_frame(&renderer, 0.9).ok);
    Picture expected(renderer.image.begin(), renderer.image.end());
    Rng rng = make_rng(3);
    for (int round = 0; round < 2; ++round) {
      std::vector<Span> spans;
      for (std::uint32_t row = 0; row < renderer.settings.height; ++row)
        for (std::uint32_t begin = 0, end; begin < renderer.settings.width; begin = end) {
          end = std::min(begin + 1 + next_u32(&rng) % 20, renderer.settings.width);
          spans.push_back(
              {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)});
        }
      shuffle(&rng, &spans);
      Picture picture(expected.size(), Vec3{-1, -1, -1});
      make_tracers(&renderer);
      Tracer tracer = renderer.tracers[0];
      trace_spans(&tracer, spans.data(), static_cast<std::uint32_t>(spans.size()), Aov::none, picture.data());
      CHECK(same_picture(picture, expected));
    }
  }
}

// Goal: the picture does not depend on the accelerator. Method: differential over the list of accelerators.
TEST_CASE("picture_is_independent_of_accelerator") {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(effort(6)); ++seed) {
    auto generated = generate_scene(kRich, seed);
    Settings settings = settings_for(kRich, 30, 22);
    Picture expected = render_picture(generated->scene, settings, 0.5, &kBruteAccel);
    for (const AccelInfo* accel : kAccelList) {
      CAPTURE(std::string(accel->name));
      CAPTURE(seed);
      CHECK(same_picture(render_picture(generated->scene, settings, 0.5, accel), expected));
    }
  }
}

// Goal: progressive refinement ends with the picture of a direct frame. Method: differential, stopping at every batch.
TEST_CASE("picture_is_independent_of_progressive_refinement") {
  auto generated = generate_scene(kRich, 8);
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t threads = i % 2 ? 3 : 1;
    Settings settings = small_settings(kAllOrSome[i]);
    Picture expected = render_picture(generated->scene, settings, 0.3);
    settings.threads = threads;
    auto test = make_renderer(generated->scene, settings);
    Renderer& renderer = test->renderer;
    std::vector<Span> spans(progressive_spans_max(settings));
    REQUIRE(begin_frame(&renderer, {0.3}).ok);
    Progressive progressive;
    int steps = 0;
    while (!advance_progressive(&renderer, {spans.data(), static_cast<std::uint32_t>(spans.size())}, 0, &progressive))
      ++steps;
    CHECK(steps >= 5);
    CHECK(progressive.pixels_traced == std::uint64_t(settings.width) * settings.height);
    CHECK(same_image(renderer.image, expected));
  }
}

// Goal: a frame depends only on its time, not on earlier frames. Method: differential, times in two orders.
TEST_CASE("picture_is_independent_of_earlier_frames") {
  auto generated = generate_scene(kRich, 9);
  auto test = make_renderer(generated->scene, small_settings(kSome[1]));
  for (double seconds : {1.5, 0.0})
    for (const Traced& traced : kAllOrSome) {  // without memory planned for corners
      REQUIRE(change_settings(&test->renderer, small_settings(traced)).ok);
      REQUIRE(render_frame(&test->renderer, seconds).ok);
      CAPTURE(seconds);
      CHECK(same_image(test->renderer.image, render_picture(generated->scene, small_settings(traced), seconds)));
    }
}
