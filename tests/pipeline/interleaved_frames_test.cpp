// Frames that trace the halves of a checkerboard in turn.
#include <doctest/doctest.h>

#include <cstring>

#include "engine/coherent.h"
#include "engine/last_picture.h"
#include "engine/prepare.h"
#include "engine/recolor.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

Settings settings_of(Resolution resolution, float contrast = 0) {
  Settings settings = settings_for(kAllFeatures, 45, 34);
  settings.resolution = resolution, settings.selective_contrast = contrast;
  return settings;
}

Picture next_picture(Renderer* renderer, double seconds) {
  REQUIRE(render_frame(renderer, seconds).ok);
  return Picture(renderer->image.begin(), renderer->image.end());
}

Camera aside(const Renderer& renderer, float degrees) {
  Camera camera = renderer.camera;
  camera.node = kNone;
  const auto angle = static_cast<float>(radians(static_cast<double>(degrees)));
  const Vec3 d = camera.eye - camera.target;
  camera.eye = camera.target + Vec3{d.x + d.z * angle, d.y, d.z - d.x * angle};
  return camera;
}

// Pictures of a sequence in which things move, then the camera, then nothing.
std::vector<Picture> sequence(const Scene& scene, const Settings& settings) {
  auto test = make_renderer(scene, settings);
  Renderer* renderer = &test->renderer;
  std::vector<Picture> pictures;
  for (double seconds : {0.3, 0.34, 0.38, 0.42}) pictures.push_back(next_picture(renderer, seconds));
  for (int i = 0; i < 3; ++i) {
    REQUIRE(set_camera(renderer, aside(*renderer, 1)).ok);
    pictures.push_back(next_picture(renderer, 0.42));
  }
  for (int i = 0; i < 2; ++i) pictures.push_back(next_picture(renderer, 0.42));
  return pictures;
}

std::uint64_t camera_rays(const Renderer& renderer) {
  return total_counts(renderer).rays[static_cast<int>(RayKind::primary)];
}

}  // namespace

// Goal: the first picture is a plain checkerboard, and the second of what rests the exact one, at half of its rays.
// Method: differential, bit for bit, over generated scenes, with selective rendering and without; then it stays exact.
TEST_CASE("interleaved_frames_complete_what_rests") {
  for (float contrast : {0.0f, 0.25f})
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(effort(3)); ++seed) {
      auto generated = generate_scene(kAllFeatures, seed);
      const Picture exact = render_picture(generated->scene, settings_of(Resolution::full, contrast), 0.4);
      const Picture half = render_picture(generated->scene, settings_of(Resolution::checkerboard, contrast), 0.4);
      REQUIRE(!same_picture(exact, half));
      auto test = make_renderer(generated->scene, settings_of(Resolution::interleaved, contrast));
      CAPTURE(seed);
      CAPTURE(contrast);
      CHECK(same_picture(next_picture(&test->renderer, 0.4), half));
      const std::uint64_t rays = camera_rays(test->renderer);
      for (int i = 0; i < 3; ++i) {
        CHECK(same_picture(next_picture(&test->renderer, 0.4), exact));
        if (contrast == 0) CHECK(camera_rays(test->renderer) <= rays);
      }
      next_picture(&test->renderer, 0.5);
      CHECK(!same_picture(next_picture(&test->renderer, 0.4), exact));
      CHECK(same_picture(next_picture(&test->renderer, 0.4), exact));
      Camera camera = test->renderer.camera;
      camera.node = kNone;
      REQUIRE(set_camera(&test->renderer, camera).ok);
      next_picture(&test->renderer, 0.4);
      CHECK(test->renderer.frame.last->rests);
      next_picture(&test->renderer, 0.5);  // before the same camera, things have moved
      CHECK_FALSE(test->renderer.frame.last->rests);
    }
}

// Goal: a sequence does not depend on the number of threads, on how frames are driven, or on when it is rendered.
// Method: differential, bit for bit; coherent frames, which interleaved ones never are, take the same way.
TEST_CASE("interleaved_frames_are_independent_of_threads") {
  for (float contrast : {0.0f, 0.25f}) {
    auto generated = generate_scene(kAllFeatures, 5);
    Settings settings = settings_of(Resolution::interleaved, contrast);
    const std::vector<Picture> expected = sequence(generated->scene, settings);
    for (std::uint32_t threads : {1u, 2u, 7u}) {
      settings.threads = threads;
      const std::vector<Picture> pictures = sequence(generated->scene, settings);
      CAPTURE(threads);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        CAPTURE(i);
        CHECK(same_picture(pictures[i], expected[i]));
      }
    }
    settings.threads = 1;
    auto test = make_renderer(generated->scene, settings);
    for (std::size_t i = 0; i < 4; ++i) {
      REQUIRE(render_coherent(&test->renderer, 0.3 + 0.04 * static_cast<double>(i)).ok);
      CHECK(std::memcmp(test->renderer.image.data, expected[i].data(), test->renderer.image.bytes()) == 0);
    }
  }
}

// Goal: no picture depends on how it is divided into spans. Method: a picture of what moves, traced again in pieces by
// one tracer, in other orders.
TEST_CASE("interleaved_frames_are_independent_of_spans") {
  auto generated = generate_scene(kAllFeatures, 6);
  auto test = make_renderer(generated->scene, settings_of(Resolution::interleaved));
  Renderer* renderer = &test->renderer;
  next_picture(renderer, 0.3);
  REQUIRE(prepare_frame(renderer, 0.36).ok);
  REQUIRE(set_camera(renderer, aside(*renderer, 1)).ok);
  REQUIRE(prepare_frame(renderer, 0.36).ok);
  follow_picture(renderer);
  Rng rng = make_rng(3);
  Picture first;
  for (int round = 0; round < 3; ++round) {
    std::vector<Span> spans;
    for (std::uint32_t row = 0; row < 34; ++row)
      for (std::uint32_t begin = 0, end; begin < 45; begin = end) {
        end = round == 0 ? 45 : std::min(begin + 1 + next_u32(&rng) % 20, 45u);
        spans.push_back(
            {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)});
      }
    if (round > 0)
      for (std::size_t i = spans.size(); i > 1; --i) std::swap(spans[i - 1], spans[next_u32(&rng) % i]);
    Picture picture(renderer->image.count, Vec3{-1, -1, -1});
    trace_spans(&renderer->tracers[0], spans.data(), static_cast<std::uint32_t>(spans.size()), Aov::none,
                picture.data());
    if (round == 0) first = picture;
    CHECK(same_picture(picture, first));
  }
  CHECK(!same_picture(first, render_picture(generated->scene, settings_of(Resolution::checkerboard), 0.36)));
}

// Goal: after a cut pictures begin anew, with a plain checkerboard. Method: differential; other settings, a recoloured
// surface, and a frame of which only a part was traced in between.
TEST_CASE("interleaved_frames_begin_anew_after_a_cut") {
  auto generated = generate_scene(kAllFeatures, 2);
  Settings settings = settings_of(Resolution::interleaved), other = settings;
  other.ray_depth = 1;
  Settings plain = other;
  plain.resolution = Resolution::checkerboard;
  auto test = make_renderer(generated->scene, settings, nullptr, nullptr, true);
  Renderer* renderer = &test->renderer;
  next_picture(renderer, 0.4);
  REQUIRE(change_settings(renderer, other).ok);
  CHECK(same_picture(next_picture(renderer, 0.4), render_picture(generated->scene, plain, 0.4)));
  next_picture(renderer, 0.4);
  REQUIRE(change_settings(renderer, plain).ok);
  next_picture(renderer, 0.4);  // traces none of the other half
  REQUIRE(change_settings(renderer, other).ok);
  const Picture checkerboard = next_picture(renderer, 0.4);
  CHECK(same_picture(checkerboard, render_picture(generated->scene, plain, 0.4)));
  Material material = renderer->scene.materials[0];
  material.diffuse = material.diffuse * 0.5f;
  const Picture exact = next_picture(renderer, 0.4);
  REQUIRE(change_material(renderer, 0, material).ok);
  const Picture recolored = next_picture(renderer, 0.4);
  REQUIRE(change_settings(renderer, plain).ok);
  CHECK(same_picture(recolored, next_picture(renderer, 0.4)));
  CHECK(!same_picture(recolored, exact));
}

// Goal: parts of a picture, as those shared with servers, never build on others. Method: rows after whole pictures
// equal those of a checkerboard, and the next whole picture still builds on the last whole one.
TEST_CASE("interleaved_frames_in_parts_are_a_checkerboard") {
  auto generated = generate_scene(kAllFeatures, 3);
  const Picture half = render_picture(generated->scene, settings_of(Resolution::checkerboard), 0.4);
  const Picture exact = render_picture(generated->scene, settings_of(Resolution::full), 0.4);
  auto test = make_renderer(generated->scene, settings_of(Resolution::interleaved));
  Renderer* renderer = &test->renderer;
  next_picture(renderer, 0.4);
  renderer->spans.count = 20;
  REQUIRE(render_frame(renderer, 0.4).ok);
  renderer->spans.count = 34;
  CHECK(std::memcmp(renderer->image.data, half.data(), 20 * 45 * sizeof(Vec3)) == 0);
  CHECK(same_picture(next_picture(renderer, 0.4), exact));
}

// Goal: where the camera rests and a body moves, what it does not touch is exact, and it leaves no ghost. Method: a
// bright sheet that slides over a dark one under ambient light: after some frames, each pixel is of one of them, or
// lies between the two at the sheet's edge.
TEST_CASE("interleaved_frames_leave_no_ghosts") {
  auto generated = generate_scene(bit(Feature::animation) | bit(Feature::ambient), 4);
  const Scene& scene = generated->scene;
  Settings settings = settings_of(Resolution::interleaved);
  settings.samples_per_pixel = 1;
  Settings full = settings, plain = settings;
  full.resolution = Resolution::full, plain.resolution = Resolution::checkerboard;
  auto test = make_renderer(scene, settings);
  double error = 0, plain_error = 0;
  for (int frame = 0; frame < 10; ++frame) {
    const double seconds = 0.1 + 0.03 * frame;
    const Picture picture = next_picture(&test->renderer, seconds), exact = render_picture(scene, full, seconds);
    const Picture checkerboard = render_picture(scene, plain, seconds);
    if (frame == 0) continue;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      error += static_cast<double>(max_component(abs(picture[i] - exact[i])));
      plain_error += static_cast<double>(max_component(abs(checkerboard[i] - exact[i])));
    }
  }
  CAPTURE(error);
  CAPTURE(plain_error);
  CHECK(plain_error > 0);
  CHECK(error < 0.6 * plain_error);
}

// Goal: memory planned for other settings has no room for it, and that is said. Method: change the settings.
TEST_CASE("interleaved_frames_are_refused_without_memory") {
  auto generated = generate_scene(kAllFeatures, 3);
  auto test = make_renderer(generated->scene, settings_of(Resolution::half));
  const Status refused = change_settings(&test->renderer, settings_of(Resolution::interleaved));
  CHECK_FALSE(refused.ok);
  CHECK(std::strstr(refused.message, "plan with --resolution interleaved") != nullptr);
  CHECK(test->renderer.last_picture.pixels.empty());
  CHECK(test->renderer.last_picture.steps.empty());
}
