// The viewer on no screen, by a script of buttons and a clock of its own.
#include "app/viewer.h"

#include <doctest/doctest.h>

#include "app/options.h"
#include "platform/null/null.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

// Frames of a still that are rendered within a budget, where the user leaves at a time.
std::uint32_t frames_until(std::uint64_t quit_ns, double budget_ms) {
  platform::Event script[1];
  script[0].type = platform::EventType::quit, script[0].time_ns = quit_ns;
  platform::NullSettings settings;
  settings.script = script, settings.script_count = 1;
  platform::null_configure(settings);
  CommonOptions common;
  common.scene = "cube", common.size = "8x8", common.threads = 1;
  ViewOptions options;
  options.backend = "null", options.rotation = 0;
  Viewer viewer;
  REQUIRE(open_viewer(options, "cube", 8, 8, &viewer).ok);
  OpenScene opened;
  OpenFront front;
  FrontSource ladder;
  ladder.file = "no-such.front", ladder.may_be_new = true;
  REQUIRE(open_scene_with_front(common, ladder, viewer_bytes, &opened, &front).ok);
  BudgetOptions budgeted;
  budgeted.ms = budget_ms;
  Budget budget;
  start_budget(budgeted, front, opened.renderer, 16, &budget);
  viewer.budget = &budget;
  bool again;
  REQUIRE(run_viewer(&viewer, &opened.renderer, &again).ok);
  CHECK(viewer.quit);
  close_viewer(&viewer);
  platform::null_configure(platform::NullSettings());
  return viewer.frames_finished;
}

}  // namespace

// Goal: a still with a budget is rendered again until its settings are settled, and no longer. Method: a user who
// leaves after ten seconds of the screen's clock, and one who leaves after a hundred; a frame takes a sixtieth of one.
TEST_CASE("viewer_settles_a_still_within_a_budget") {
  std::uint32_t early = frames_until(10 * kSecond, 1e6), late = frames_until(100 * kSecond, 1e6);
  CHECK(early > 1);
  CHECK(early == late);
  std::uint32_t too_dear = frames_until(100 * kSecond, 1e-3);
  CHECK(too_dear > 1);
  CHECK(too_dear <= 100);
}
