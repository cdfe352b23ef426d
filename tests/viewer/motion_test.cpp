// Motion to photon: the record of latencies, and when a picture gives way to a newer one.
#include "viewer/motion.h"

#include <doctest/doctest.h>

#include <cstring>

#include "viewer/follow.h"
#include "viewer/stage.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kMs = 1'000'000;

double ms(const Motion& motion, double part) { return latency_ns(motion, part) * 1e-6; }

}  // namespace

// Goal: latencies are those of a closed form, however often the buttons are read. Method: a camera that moves all the
// time, pictures of 100 ms that show the camera of their begin: latencies are spread evenly from 100 to 200 ms. Buttons
// read every 1, 5 and 25 ms.
TEST_CASE("motion_latency_is_that_of_a_closed_form") {
  for (std::uint64_t step : {1, 5, 25}) {
    CAPTURE(step);
    Motion motion;
    for (std::uint64_t at = 0; at < 2000; at += step) {
      if (at > 0) note_motion(&motion, (at - step) * kMs, at * kMs);
      if (at % 100 == 0) show_motion(&motion, at * kMs), take_motion(&motion);
    }
    CHECK(motion.total_ns == 1800 * kMs);
    for (double part : {0.01, 0.25, 0.5, 0.75, 0.99})
      CHECK(ms(motion, part) == doctest::Approx(100 + 100 * part).epsilon(0.02));
  }
}

// Goal: motion counts from its own time until it is seen, so a dropped picture does not hide any. Method: a picture
// that is dropped 60 ms after its begin, and a press during the next one.
TEST_CASE("motion_of_a_dropped_picture_counts_until_it_is_seen") {
  Motion motion;
  note_motion(&motion, 0, 1 * kMs);
  take_motion(&motion);  // dropped
  note_motion(&motion, 60 * kMs, 61 * kMs);
  take_motion(&motion);
  note_motion(&motion, 80 * kMs, 80 * kMs);  // a press: not part of the picture
  show_motion(&motion, 101 * kMs);
  CHECK(motion.total_ns == 2 * kMs);
  CHECK(ms(motion, 0.25) == doctest::Approx(40.5).epsilon(0.02));
  CHECK(ms(motion, 1) == doctest::Approx(101).epsilon(0.02));
  show_motion(&motion, 150 * kMs);  // shows nothing new
  CHECK(motion.total_ns == 2 * kMs);
  take_motion(&motion);
  show_motion(&motion, 200 * kMs);
  CHECK(motion.total_ns == 3 * kMs);
  CHECK(ms(motion, 1) == doctest::Approx(121).epsilon(0.02));
}

// Goal: whatever the time, figures are within 2 %, memory is fixed and no motion is lost. Method: single latencies from
// a microsecond to an hour; more presses during one picture than there is room for.
TEST_CASE("motion_record_has_room_for_every_latency") {
  for (double latency_ms : {0.05, 0.9, 7.0, 16.7, 250.0, 3000.0, 60'000.0}) {
    CAPTURE(latency_ms);
    Motion motion;
    const std::uint64_t at = 10 * kMs, ns = static_cast<std::uint64_t>(latency_ms * 1e6);
    motion.noted_ns = at - 1000;
    note_motion(&motion, at - 1000, at);
    take_motion(&motion);
    show_motion(&motion, at + ns);
    CHECK(ms(motion, 0.5) == doctest::Approx(latency_ms).epsilon(0.02));
  }
  Motion motion;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    note_motion(&motion, i * 10 * kMs, i * 10 * kMs);
    if (i % 40 == 0) take_motion(&motion);
  }
  take_motion(&motion);
  show_motion(&motion, 1001 * kMs);
  CHECK(motion.span_count == 0);
  CHECK(motion.total_ns >= 100 * kMs);
  CHECK(ms(motion, 1) == doctest::Approx(992).epsilon(0.02));
  show_motion(&motion, 3'600'000 * kMs);
  CHECK(latency_ns(Motion(), 0.5) == 0);
}

// Goal: a picture gives way only to one that is shown sooner, and never two in a row. Method: every case.
TEST_CASE("motion_picture_gives_way_to_a_sooner_one") {
  CHECK(gives_way({100, 99, false}));
  CHECK_FALSE(gives_way({99, 100, false}));
  CHECK_FALSE(gives_way({100, 100, false}));
  CHECK_FALSE(gives_way({100, 99, true}));
  CHECK_FALSE(gives_way({100, 0, false}));
  CHECK_FALSE(gives_way({0, 0, false}));
}

namespace {

const Clock kScreenClock = {platform::kNullBackend.now_ns, platform::kNullBackend.sleep_ns};

// Pictures finished while a button is held for two seconds, on a device that takes this long per pixel.
std::uint32_t finished_while_held(double ns_per_pixel) {
  Stage stage;
  stage.press(1, platform::Button::right);
  stage.leave(3);
  stage.open("cube");
  OpenScene opened;
  stage.load("cube", "off", &opened);
  opened.renderer.pace.ns_per_pixel = ns_per_pixel;
  opened.renderer.pace.clock = &kScreenClock;
  bool again;
  REQUIRE(run_viewer(&stage.viewer, &opened.renderer, &again).ok);
  CHECK(stage.viewer.motion.total_ns > 0);
  CHECK(ms(stage.viewer.motion, 1) < 150);  // a coarse picture is soon visible
  return stage.viewer.frames_finished - 1;  // without the first
}

}  // namespace

// Goal: on a device alone, a coarse picture gives way to a newer one, unless the rest of it is traced sooner than that
// would be visible. Method: an emulated device that traces all of a picture in the slice of 25 ms that shows it coarse,
// two thirds of it, or one third.
TEST_CASE("viewer_completes_what_is_nearly_finished") {
  CHECK(finished_while_held(1200) > 30);
  CHECK(finished_while_held(2000) > 20);
  CHECK(finished_while_held(4000) == 0);
}

// Goal: the viewer measures what the user sees, and says so on the overlay. Method: a scripted press on the null
// screen, where an update takes 16.7 ms; a picture that nobody moves has no figure.
TEST_CASE("viewer_measures_motion_to_photon") {
  for (bool moved : {false, true}) {
    Stage stage;
    if (moved) stage.press(1, platform::Button::right), stage.press(2, platform::Button::right, false);
    stage.leave(3);
    stage.open("cube");
    OpenScene opened;
    stage.show("cube", &opened);
    const Motion& motion = stage.viewer.motion;
    CHECK((motion.total_ns > 0) == moved);
    HudText text;
    write_latency(motion, &text);
    CHECK(text.line_count == (moved ? 1 : 0));
    if (!moved) continue;
    CHECK(std::strstr(text.lines[0], "motion to photon"));
    CHECK(static_cast<double>(motion.total_ns) * 1e-9 == doctest::Approx(1).epsilon(0.05));
    CHECK(ms(motion, 0.01) >= 16);
    CHECK(motion.span_count == 0);  // all of it is on the screen
  }
}
