// The reference beside the picture.
#include "desktop/reference_view/reference_view.h"

#include <doctest/doctest.h>

#include "desktop/reference/reference.h"
#include "engine/frame.h"
#include "platform/null/null.h"
#include "viewer/viewer.h"

using namespace pocketray;

namespace {

struct Scenery {
  OpenScene opened;
  SideBySide* side_by_side = nullptr;
  Renderer* renderer = &opened.renderer;

  Scenery(const char* scene, const char* reference, std::uint32_t threads) {
    CommonOptions common;
    common.scene = scene, common.size = "24x16", common.threads = threads;
    common.settings["area-lights"].count = 1;
    OpenHooks hooks;
    hooks.output_bytes = viewer_bytes;
    REQUIRE(open_scene(common, hooks, &opened).ok);
    REQUIRE(start_scene(&opened, common).ok);
    SideBySideOptions options;
    options.reference = reference;
    side_by_side = kReferenceView.open(options, *renderer, 32, false);
    REQUIRE(side_by_side != nullptr);
  }
  ~Scenery() { kReferenceView.close(side_by_side); }

  // Refines until the reference has `samples` samples per seed; the deadlines are too short for a whole pass.
  void refine(std::uint32_t samples, double seconds, std::uint64_t slice_ns = 200'000) {
    do REQUIRE(kReferenceView.advance(side_by_side, renderer, seconds, 1, clock_ns() + slice_ns).ok);
    while (kReferenceView.samples(*side_by_side) < 2 * samples);
  }
};

// The mean of both seeds, traced at once.
std::vector<Vec3d> whole_reference(Renderer* renderer, Transport transport, std::uint32_t samples) {
  std::vector<std::uint8_t> memory(reference_need(renderer->frame) + kArenaAlignment);
  Arena arena = make_arena("reference", memory.data(), memory.size());
  Reference reference = make_reference(renderer->frame, &arena, transport == Transport::physical ? kGuidePathCount : 0);
  ReferenceOptions o;
  o.transport = transport, o.samples_per_pixel = samples;
  std::vector<Vec3d> sum(renderer->image.count), mean(renderer->image.count);
  for (std::uint64_t seed : {1u, 2u}) {
    o.seed = seed;
    trace_reference(reference, o, 0, renderer->settings.height, mean.data());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += mean[i] * 0.5;
  }
  return sum;
}

bool is_near(const Vec3& a, const Vec3d& b) {
  auto near = [](float x, double y) { return std::fabs(static_cast<double>(x) - y) <= 1e-6 * (1 + std::fabs(y)); };
  return near(a.x, b.x) && near(a.y, b.y) && near(a.z, b.z);
}

// Number of pixels in the right half that differ from the reference of the prepared frame.
std::uint32_t unlike_reference(const Scenery& s, Transport transport, const Vec3* shown) {
  std::uint32_t samples = kReferenceView.samples(*s.side_by_side) / 2, count = 0;
  std::vector<Vec3d> before = whole_reference(s.renderer, transport, samples),
                     after = whole_reference(s.renderer, transport, samples + 1);
  for (std::uint32_t i = 0; i < s.renderer->image.count;
       ++i)  // the upper rows may have one more sample from an unfinished pass
    if (i % 24 > 12) count += !is_near(shown[i], before[i]) && !is_near(shown[i], after[i]);
  return count;
}

}  // namespace

// Goal: the left half is the picture and the right half the reference, however its rows were traced. Method: time
// slices too short for all rows, one and three threads, both kinds; compared with a reference traced at once, of the
// same view and time with the scene's own settings, unlike the picture's.
TEST_CASE("side_by_side_shows_picture_and_reference") {
  for (const char* kind : {"model", "physical"})
    for (std::uint32_t threads : {1u, 3u}) {
      Scenery s("seesaw", kind, threads);
      Settings plain = s.renderer->settings;
      plain.normals = NormalMode::flat, plain.ray_depth = 0;
      REQUIRE(change_settings(s.renderer, plain).ok);
      REQUIRE(render_frame(s.renderer, 0.4).ok);
      std::vector<Vec3> picture(s.renderer->image.begin(), s.renderer->image.end());
      s.refine(3, 0.4);
      CHECK(s.renderer->settings.normals == NormalMode::flat);
      CHECK(s.renderer->settings.ray_depth == 0);
      const Vec3* shown = kReferenceView.picture(s.side_by_side, *s.renderer);
      Settings own = plain;
      own.normals = NormalMode::as_scene;
      REQUIRE(change_settings(s.renderer, own).ok);
      REQUIRE(begin_frame(s.renderer, {0.4}).ok);
      std::uint32_t other = 0;
      for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 24; ++x) {
          std::size_t i = y * 24 + x;
          if (x < 12) other += shown[i].x != picture[i].x || shown[i].y != picture[i].y || shown[i].z != picture[i].z;
        }
      CHECK(other == 0);
      CHECK(unlike_reference(s, kind[0] == 'm' ? Transport::model : Transport::physical, shown) == 0);
      HudText text;
      kReferenceView.write_lines(*s.side_by_side, &text);
      CHECK(text.line_count == 2);
    }
}

// Goal: samples of different views or times are never mixed. Method: the camera moves, then time passes; sampling
// restarts.
TEST_CASE("side_by_side_begins_anew_when_the_view_changes") {
  Scenery s("seesaw", "model", 1);
  REQUIRE(render_frame(s.renderer, 0).ok);
  s.refine(40, 0);
  std::uint32_t before = kReferenceView.samples(*s.side_by_side);
  REQUIRE(kReferenceView.advance(s.side_by_side, s.renderer, 0, 2, 0).ok);
  CHECK(kReferenceView.samples(*s.side_by_side) >= before);
  Camera camera = s.renderer->view.camera;
  camera.eye.x += 0.5f;
  REQUIRE(set_camera(s.renderer, camera).ok);
  REQUIRE(kReferenceView.advance(s.side_by_side, s.renderer, 0, 3, 0).ok);
  CHECK(kReferenceView.samples(*s.side_by_side) == 0);
  s.refine(4, 0);
  const Vec3* shown = kReferenceView.picture(s.side_by_side, *s.renderer);
  REQUIRE(begin_frame(s.renderer, {0}).ok);
  CHECK(unlike_reference(s, Transport::model, shown) == 0);
  kReferenceView.forget(s.side_by_side);
  shown = kReferenceView.picture(s.side_by_side, *s.renderer);
  std::uint32_t other = 0;
  for (std::size_t i = 0; i < s.renderer->image.count; ++i)
    other += i % 24 != 12 && shown[i].y != s.renderer->image[i].y;
  CHECK(other == 0);
  REQUIRE(kReferenceView.advance(s.side_by_side, s.renderer, 1.5, 4, 0).ok);
  CHECK(kReferenceView.samples(*s.side_by_side) == 0);
}

// Goal: the user sees it and can hide it, and time stands still while it shows. Method: an in-memory screen and a
// script: two frames with the reference on the right half; then the key.
TEST_CASE("side_by_side_is_shown_by_the_viewer") {
  CommonOptions common;
  common.scene = "seesaw", common.size = "24x16", common.threads = 1;
  std::vector<std::uint32_t> screens[2];
  for (bool put_away : {false, true}) {
    std::vector<std::uint32_t>* screen = &screens[put_away];
    screen->resize(24 * 16);
    platform::Event script[2];
    script[0].type = platform::EventType::button_down, script[0].button = platform::Button::hud;
    script[1].type = platform::EventType::button_down, script[1].button = platform::Button::side_by_side;
    platform::NullSettings settings;
    settings.screen = screen->data(), settings.screen_bytes = screen->size() * 4;
    settings.script = script, settings.script_count = put_away ? 2 : 1;
    platform::null_configure(settings);
    ViewOptions options;
    options.backend = "null", options.rotation = 0, options.frame_count = 2;
    Viewer viewer;
    REQUIRE(open_viewer(options, "seesaw", 24, 16, &viewer).ok);
    OpenScene opened;
    OpenHooks hooks;
    hooks.output_bytes = viewer_bytes;
    REQUIRE(open_scene(common, hooks, &opened).ok);
    REQUIRE(start_scene(&opened, common).ok);
    SideBySideOptions asked;
    asked.reference = "model";
    viewer.side_by_side = kReferenceView.open(asked, opened.renderer, 32, false);
    bool again;
    REQUIRE(run_viewer(&viewer, &opened.renderer, &again).ok);
    CHECK(viewer.frames_finished == 2);
    CHECK((kReferenceView.samples(*viewer.side_by_side) > 0) == !put_away);
    kReferenceView.close(viewer.side_by_side);
    close_viewer(&viewer);
    platform::null_configure(platform::NullSettings());
  }
  std::uint32_t line = 0;
  for (std::uint32_t y = 0; y < 16; ++y) line += (screens[0][y * 24 + 12] & 0xFFFFFF) == 0xFFFFFF;
  CHECK(line == 16);
  std::uint32_t left = 0, right = 0;
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 24; ++x)
      (x < 12 ? left : right) += x != 12 && screens[0][y * 24 + x] != screens[1][y * 24 + x];
  CHECK(left == 0);
  CHECK(right > 16);
}
