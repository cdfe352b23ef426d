// The emulated CPU: frames take its time and stay the same.
#include "engine/pace.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <thread>

#include "engine/frame.h"
#include "engine/progressive.h"
#include "session/report.h"
#include "support/generated_scene.h"
#include "viewer/hud.h"

using namespace pocketray;

namespace {

struct Subject {
  static constexpr std::uint32_t kFeatures = bit(Feature::point_light) | bit(Feature::mirror);
  std::unique_ptr<GeneratedScene> generated = generate_scene(kFeatures, 7);
  std::unique_ptr<TestRenderer> test;
  Renderer* renderer = nullptr;

  explicit Subject(std::uint32_t threads = 1, std::uint32_t samples = 1) {
    Settings settings = settings_for(kFeatures, 96, 72);
    settings.threads = threads, settings.samples_per_pixel = samples;
    test = make_renderer(generated->scene, settings);
    renderer = &test->renderer;
  }

  double trace_ms() {
    Status status = render_frame(renderer, 0);
    REQUIRE_MESSAGE(status.ok, status.message);
    return renderer->timings.trace_ms;
  }
  Picture picture() const { return Picture(renderer->image.begin(), renderer->image.end()); }
};

std::uint64_t virtual_now_ns = 0, virtual_overrun_ns = 0;
constexpr Clock kVirtualClock = {[] { return virtual_now_ns += 500; },
                                 [](std::uint64_t duration) { virtual_now_ns += duration + virtual_overrun_ns; }};

}  // namespace

// Goal: the arithmetic of the pace. Method: by hand, including the limits.
TEST_CASE("pace_arithmetic") {
  Pace none, slow, fixed;
  slow.slowdown = 12.5;
  fixed.ns_per_pixel = 8841;
  CHECK_FALSE(is_paced(none));
  CHECK(is_paced(slow));
  CHECK(is_paced(fixed));
  CHECK(paced_ns(none, 100, 1234) == 1234);
  CHECK(paced_ns(slow, 100, 1000) == 12500);
  CHECK(paced_ns(fixed, 100, 1000) == 884100);
  CHECK(paced_ns(fixed, 0, 1000) == 0);
  CHECK(paced_ns(slow, 0, ~std::uint64_t{0}) == 3'600'000'000'000);
  const Span spans[] = {{0, 0, 320}, {1, 10, 20}};
  CHECK(span_pixel_count(spans, 2) == 330);
  std::uint64_t span_ns[] = {1000, 50};
  pace_spans(slow, spans, 2, 2, span_ns);
  CHECK(span_ns[0] == 12500);
  CHECK(span_ns[1] == 625);
  pace_spans(fixed, spans, 2, 2, span_ns);  // two threads, each taking twice as long per pixel
  CHECK(span_ns[0] == 2 * 320 * 8841);
  CHECK(span_ns[1] == 2 * 10 * 8841);
}

// Goal: a paced frame takes slowdown times as long as an unpaced one, and so do its rows. Method: the processor time of
// tracing, which excludes sleeping and waiting for others on a busy machine: the rows report at least slowdown times as
// much, and the frame took no less than its rows, preparation included: where the latter's sleep overran, tracing makes
// up for it. An upper bound would depend on the machine; paced_ns() tests the factor exactly.
TEST_CASE("pace_slows_a_frame_by_its_factor") {
  Subject subject;
  Renderer* renderer = subject.renderer;
  constexpr double kSlowdown = 6;
  auto rows_ms = [&] {
    double ms = 0;
    for (std::uint64_t ns : renderer->row_ns) ms += static_cast<double>(ns) * 1e-6;
    return ms;
  };
  auto processor_ms = [] { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  subject.trace_ms();
  for (double slowdown : {1.0, kSlowdown}) {
    renderer->pace.slowdown = slowdown;
    const std::uint64_t begin_ns = clock_ns();
    const double begin_ms = processor_ms();
    subject.trace_ms();
    const double used_ms = processor_ms() - begin_ms, frame_ms = static_cast<double>(clock_ns() - begin_ns) * 1e-6;
    MESSAGE("at 1/" << slowdown << " of the speed: " << frame_ms << " ms, rows " << rows_ms() << " ms, processor "
                    << used_ms << " ms");
    CHECK(rows_ms() >= 0.6 * slowdown * used_ms);  // the rest is preparing the frame, sleeping and waking
    CHECK(frame_ms >= rows_ms() - 0.2);            // waits are exact to 0.2 ms
  }
}

// Goal: rows that several threads trace in parts have the time of all of them. Method: against the processor's time;
// the rest of it is preparing the frame and waking threads.
TEST_CASE("rows_have_the_time_of_all_threads") {
  Subject subject(6, 16);
  subject.trace_ms();
  const double begin = static_cast<double>(std::clock());
  subject.trace_ms();
  const double used_ns = 1e9 * (static_cast<double>(std::clock()) - begin) / CLOCKS_PER_SEC;
  double rows_ns = 0;
  for (std::uint64_t ns : subject.renderer->row_ns) rows_ns += static_cast<double>(ns);
  CHECK(rows_ns >= 0.6 * used_ns);
}

// Goal: the picture is the same at any pace. Method: whole frames with one and two threads, bit by bit.
TEST_CASE("pace_leaves_the_picture_as_it_is") {
  Subject plain;
  plain.trace_ms();
  for (std::uint32_t threads : {1u, 2u}) {
    Subject paced(threads);
    paced.renderer->pace.slowdown = 3;
    paced.trace_ms();
    CHECK(same_picture(plain.picture(), paced.picture()));
  }
}

// Goal: a fixed time per pixel is kept, by whole frames and by progressive ones; the costs of rows add up to the frame;
// each frame starts without debts. Method: a virtual clock, by which tracing takes next to nothing and sleeps overrun;
// waiting is exact to 0.2 ms of 55 ms.
TEST_CASE("pace_keeps_a_fixed_time_per_pixel") {
  constexpr double kNsPerPixel = 8000, kTolerance = 0.004;
  for (std::uint64_t overrun_ns : {0u, 60'000u, 5'000'000u}) {
    CAPTURE(overrun_ns);
    virtual_now_ns = 0, virtual_overrun_ns = overrun_ns;
    Subject subject;
    Renderer* renderer = subject.renderer;
    renderer->pace.clock = &kVirtualClock;
    renderer->pace.ns_per_pixel = kNsPerPixel;
    double wanted = static_cast<double>(renderer->settings.width) * renderer->settings.height * kNsPerPixel;
    // The last sleep of a frame may overrun with no wait left to make up for it.
    double longest = wanted * (1 + kTolerance) + static_cast<double>(overrun_ns);
    for (std::int64_t owed : {0, -30'000'000, 30'000'000}) {
      renderer->pace.owed_ns = owed;
      double ns = subject.trace_ms() * 1e6;
      CHECK(ns >= wanted * (1 - kTolerance));
      CHECK(ns <= longest);
      std::uint64_t sum = 0;
      for (std::uint64_t row_ns : renderer->row_ns) sum += row_ns;
      CHECK(static_cast<double>(sum) == doctest::Approx(wanted));
    }
    // A pixel of each tile is traced twice.
    const double again = grid_side(renderer->settings.width, 8) * grid_side(renderer->settings.height, 8) * kNsPerPixel;
    std::vector<Span> spans(progressive_spans_max(renderer->settings));
    REQUIRE(begin_frame(renderer, {0}).ok);
    Progressive progressive;
    while (!advance_progressive(renderer, {spans.data(), static_cast<std::uint32_t>(spans.size())}, 0, &progressive)) {
    }
    CHECK(static_cast<double>(progressive.trace_ns) >= (wanted + again) * (1 - kTolerance));
    CHECK(static_cast<double>(progressive.trace_ns) <= longest + again * (1 + kTolerance));
  }
}

// Goal: the display names the emulated device first, in full. Method: the longest name, slow frames, two threads.
TEST_CASE("pace_is_shown_in_the_first_line_of_the_display") {
  Subject subject(2);
  subject.renderer->pace.device = "miyoo-mini";
  Progressive progressive;
  progressive.pixels_traced = 10;
  progressive.trace_ns = 456'780;
  HudText text;
  write_hud(*subject.renderer, progressive, CameraMode::orbit, &text);
  CHECK(std::string(text.lines[0]) == "miyoo-mini  316 ms/frame  45678 ns/pixel  2 threads");
  CHECK(emulation_text(subject.renderer->pace) == ", emulating miyoo-mini: 1 times slower");
  subject.renderer->pace.device = nullptr;
  write_hud(*subject.renderer, progressive, CameraMode::orbit, &text);
  CHECK(std::string(text.lines[0]) == "315.7 ms/frame  45678 ns/pixel  2 threads");
  CHECK(emulation_text(subject.renderer->pace).empty());
}

// Goal: leaving does not wait for the emulated CPU. Method: a pace of hours, stopped from another thread, by the
// frame's own stop flag and by the pace's.
TEST_CASE("pace_wait_ends_when_stopped") {
  for (bool by_pace : {false, true}) {
    Subject subject;
    subject.renderer->pace.ns_per_pixel = 1e9;
    std::atomic<bool> stop{false};
    if (by_pace) subject.renderer->pace.stop = &stop;
    std::thread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      stop = true;
    });
    std::uint64_t start = clock_ns();
    Status status = render_frame(subject.renderer, 0, Aov::none, by_pace ? nullptr : &stop);
    other.join();
    CHECK(status.ok);
    CHECK(clock_ns() - start < 5'000'000'000);
  }
}
