// What the viewer shows of temporal coherence: the overlay of traced pixels and a line of text.
#include <doctest/doctest.h>

#include <cstdio>
#include <cstring>

#include "viewer/stage.h"
#include "viewer/steps.h"

using namespace pocketray;

namespace {

bool is_kept(const Renderer& renderer, int column, int row) {
  const Coherence& c = renderer.history.coherence;
  std::size_t tile = static_cast<std::size_t>(row / 8) * c.tile_columns + static_cast<std::size_t>(column / 8);
  return !(c.changed[tile] >> (8 * (row % 8) + column % 8) & 1);
}

// The bytes of the renderer's picture on the stage's screen, the pixels kept from the last frame dimmed or not.
std::vector<std::uint8_t> expected_screen(const Stage& stage, const Renderer& renderer, bool dims) {
  const Viewer& v = stage.viewer;
  const int bytes = v.format.bits_per_pixel / 8, line_bytes = stage.screen_width() * bytes;
  std::vector<std::uint8_t> page(static_cast<std::size_t>(line_bytes * stage.screen_height()));
  pack_rows(renderer.image.data, v.width, v.height, 0, v.height, display_of(renderer), v.format, v.rotation,
            stage.dither, page.data(), line_bytes);
  for (int row = 0; dims && row < v.height; ++row) {
    for (int column = 0; column < v.width; ++column) {
      if (!is_kept(renderer, column, row)) continue;
      ScreenPosition at = screen_position(column, row, v.width, v.height, v.rotation);
      std::uint8_t* pixel = page.data() + at.y * line_bytes + at.x * bytes;
      if (bytes == 4) {
        for (int i = 0; i < 4; ++i) pixel[i] /= 2;
        continue;
      }
      int levels[3];
      unpack_levels(v.format, read_pixel(v.format, pixel), levels);
      write_pixel(v.format, pixel, pack_levels(v.format, levels[0] / 2, levels[1] / 2, levels[2] / 2));
    }
  }
  return page;
}

std::vector<std::uint8_t> shown_screen(const Stage& stage) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(stage.screen.data());
  return {bytes, bytes + stage.screen_width() * stage.screen_height() * (stage.viewer.format.bits_per_pixel / 8)};
}

}  // namespace

// Goal: the overlay of traced pixels dims those kept from the last frame and no others, and leaves no trace when it is
// toggled off; whether the animation runs or is paused. Method: leave in the midst of an animation, with every rotation
// in turn and both pixel sizes; dim the packed picture, as the renderer left it, by hand.
TEST_CASE("viewer_dims_exactly_the_kept_pixels") {
  const struct {
    int rotation, bits_per_pixel;
    bool dither, pauses;
    int presses;
  } kRows[] = {{0, 32, false, true, 1},  {0, 32, false, true, 2},   {0, 32, false, false, 1}, {0, 16, true, true, 1},
               {90, 16, true, true, 1},  {90, 32, false, false, 1}, {90, 16, true, true, 2},  {180, 16, false, true, 1},
               {270, 32, true, true, 1}, {270, 16, true, true, 3}};
  for (const auto& row : kRows) {
    CAPTURE(row.rotation);
    CAPTURE(row.bits_per_pixel);
    CAPTURE(row.presses);
    Stage stage;
    stage.rotation = row.rotation, stage.bits_per_pixel = row.bits_per_pixel, stage.dither = row.dither;
    stage.press(0, platform::Button::hud);
    if (row.pauses) stage.press(0.4, platform::Button::x);
    for (int i = 0; i < row.presses; ++i) stage.press(0.45 + 0.1 * i, platform::Button::traced);
    stage.leave(0.8);
    stage.open("seesaw");
    OpenScene opened;
    stage.show("seesaw", &opened, "on");
    REQUIRE(opened.renderer.history.state.planned);
    REQUIRE(opened.renderer.history.state.whole_because == nullptr);
    int kept = 0;
    for (int y = 0; y < Stage::kHeight; ++y)
      for (int x = 0; x < Stage::kWidth; ++x) kept += is_kept(opened.renderer, x, y);
    CHECK(kept > 0);
    CHECK(kept < Stage::kWidth * Stage::kHeight);
    CHECK(stage.viewer.note.number == 0);
    CHECK(shown_screen(stage) == expected_screen(stage, opened.renderer, row.presses % 2 != 0));
  }
}

// Goal: the overlay of traced pixels dims nothing in a frame that was traced whole. Method: the camera moves at last.
TEST_CASE("viewer_dims_nothing_of_a_whole_frame") {
  Stage stage;
  stage.press(0, platform::Button::hud);
  stage.press(0.1, platform::Button::traced);
  stage.press(0.3, platform::Button::x);
  stage.press(0.5, platform::Button::right), stage.press(0.6, platform::Button::right, false);
  stage.leave(9);
  stage.open("seesaw");
  OpenScene opened;
  stage.show("seesaw", &opened, "on");
  CHECK(opened.renderer.history.state.whole_because != nullptr);
  CHECK(stage.viewer.traced_shown);
  CHECK(shown_screen(stage) == expected_screen(stage, opened.renderer, false));
}

// Goal: without coherence the key tells why it shows nothing. Method: coherence off, and a still that needs none.
TEST_CASE("viewer_tells_why_all_pixels_are_traced") {
  for (bool still : {false, true}) {
    Stage stage;
    stage.press(0, platform::Button::hud);
    stage.press(0.2, platform::Button::x);
    stage.press(1, platform::Button::traced);
    stage.leave(9);
    const char* scene = still ? "cube" : "seesaw";
    stage.open(scene);
    OpenScene opened;
    stage.show(scene, &opened, still ? "auto" : "off");
    CHECK_MESSAGE(std::strstr(stage.viewer.note.text, still ? "nothing moves" : "coherence is off"),
                  stage.viewer.note.text);
    CHECK(std::strstr(stage.viewer.note.text, "--coherence on") != nullptr);
    CHECK_FALSE(stage.viewer.traced);
    CHECK(shown_screen(stage) == expected_screen(stage, opened.renderer, false));
  }
}

namespace {

// The next picture of a scene, in as many steps as it takes.
void finish_picture(double seconds, Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  loop->seconds = seconds, loop->passed = true;
  do {
    REQUIRE(step_viewer(viewer, renderer, loop).ok);
  } while (!loop->finished);
}

std::string hud_line(const HudText& text, const char* start) {
  for (int i = 0; i < text.line_count; ++i)
    if (std::strncmp(text.lines[i], start, std::strlen(start)) == 0) return text.lines[i];
  return "";
}

}  // namespace

// Goal: the overlay tells how much of a frame was traced, or why all of it, and what the whole frame took. Method:
// three pictures of an animation, the last unchanged, with coherence and without.
TEST_CASE("viewer_shows_what_coherence_saves") {
  for (bool coherent : {true, false}) {
    Stage stage;
    stage.open("seesaw");
    OpenScene opened;
    stage.load("seesaw", coherent ? "on" : "off", &opened);
    Renderer* renderer = &opened.renderer;
    ViewerLoop loop;
    loop.tile_spans = arena_array<Span>(&renderer->memory.frame, progressive_spans_max(renderer->settings));
    loop.finished = true;
    finish_picture(1, &stage.viewer, renderer, &loop);
    CHECK(hud_line(loop.hud, "coherence") == (coherent ? "coherence: whole frame: no previous frame" : ""));
    finish_picture(1.05, &stage.viewer, renderer, &loop);
    if (coherent) {
      const CoherenceState& state = renderer->history.state;
      CHECK(state.pixels_traced > 0);
      CHECK(state.pixels_traced < renderer->image.count);
      char expected[100];
      std::snprintf(expected, sizeof expected, "coherence: %.1f %% traced, %.0fk search rays",
                    100 * static_cast<double>(state.pixels_traced) / renderer->image.count,
                    static_cast<double>(state.search.moving_rays + state.search.static_rays) / 1000);
      CHECK(hud_line(loop.hud, "coherence") == expected);
      CHECK(renderer->history.spent_ns > 0);
    }
    CHECK(renderer->history.prepare_ns > 0);
    CHECK(loop.progressive.trace_ns == renderer->history.prepare_ns + renderer->history.spent_ns);
    CHECK(loop.progressive.pixels_traced == renderer->image.count);
    char frame_ms[40];
    std::snprintf(frame_ms, sizeof frame_ms, "%.1f ms/frame  ", static_cast<double>(loop.progressive.trace_ns) * 1e-6);
    CHECK(hud_line(loop.hud, frame_ms) != "");
    if (coherent) {  // a slow frame: until it is finished, the display tells of the one before
      const std::string before = hud_line(loop.hud, "coherence");
      renderer->pace.ns_per_pixel = 1e8 / static_cast<double>(renderer->history.state.pixels_traced);
      loop.seconds = 1.1, loop.passed = true;
      int steps = 0;
      do {
        CHECK(hud_line(loop.hud, "coherence") == before);
        REQUIRE(step_viewer(&stage.viewer, renderer, &loop).ok);
        ++steps;
      } while (!loop.finished);
      CHECK(steps > 1);
      CHECK(loop.progressive.trace_ns > 50'000'000);
      renderer->pace.ns_per_pixel = 0;
    } else {
      finish_picture(1.1, &stage.viewer, renderer, &loop);
    }
    finish_picture(1.1, &stage.viewer, renderer, &loop);
    CHECK(hud_line(loop.hud, "coherence") == (coherent ? "coherence: 0.0 % traced, 0k search rays" : ""));
  }
}
