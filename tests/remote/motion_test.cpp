// Motion to photon: the viewer on an emulated device with a server that renders most of each frame, over links that
// lose packets.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>

#include "motion_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// What a user feels, over several courses of losses.
struct Felt {
  double median_ms = 0, late_ms = 0, gap_ms_max = 0;  // late: 99th percentile
  std::uint32_t shown = 0, dropped = 0, drops_in_a_row = 0;
};

Felt feel(MotionOptions options, int course_count) {
  Felt felt;
  Motion all;
  for (int i = 0; i < course_count; ++i) {
    options.seed = static_cast<std::uint64_t>(i + 1);
    const MotionResult r = run_motion(options);
    CHECK(r.screen == r.own_screen);
    for (std::uint32_t k = 0; k < kLatencyCount; ++k) all.ns_by_latency[k] += r.motion.ns_by_latency[k];
    all.total_ns += r.motion.total_ns;
    felt.gap_ms_max = std::max(felt.gap_ms_max, r.gap_ms_max);
    felt.shown += r.shown, felt.dropped += r.dropped;
    felt.drops_in_a_row = std::max(felt.drops_in_a_row, r.drops_in_a_row);
  }
  felt.median_ms = latency_ns(all, 0.5) * 1e-6, felt.late_ms = latency_ns(all, 0.99) * 1e-6;
  return felt;
}

// With fewer courses, chance would decide.
bool too_slow() {
  if (kEffortDivisor > 1) MESSAGE("skipped: it takes minutes under emulation or a sanitizer");
  return kEffortDivisor > 1;
}

}  // namespace

// Goal: where nothing is lost, no picture gives way, since less of it is left than a new one takes. Method: both
// policies, two round trips: the same figures, to within the clock's steps, and those of a closed form.
TEST_CASE("motion_drops_nothing_where_nothing_is_lost") {
  if (too_slow()) return;
  for (std::uint64_t round_trip_ms : {2, 40}) {
    CAPTURE(round_trip_ms);
    MotionOptions o;
    o.round_trip_ns = round_trip_ms * 1'000'000, o.lost_per_million = 0;
    MotionResult results[2];
    for (bool drops : {false, true}) o.drops_frames = drops, results[drops] = run_motion(o);
    CHECK(results[1].dropped == 0);
    CHECK(results[1].shown > 20);
    CHECK(results[0].ms(0.5) == doctest::Approx(results[1].ms(0.5)).epsilon(0.01));
    CHECK(results[0].ms(0.99) == doctest::Approx(results[1].ms(0.99)).epsilon(0.01));
    // Pictures one after another, each of the camera at its begin, show motion after one to two of them.
    CHECK(results[1].ms(0.5) == doctest::Approx(1.5 * results[1].gap_ms_mean).epsilon(0.1));
    CHECK(results[1].ms(0.99) == doctest::Approx(2 * results[1].gap_ms_mean).epsilon(0.15));
    CHECK(results[1].screen == results[1].own_screen);
  }
}

// Goal: where a packet is lost, the newest input wins: the latest percent of motion is seen sooner than if each picture
// were completed, and the picture at rest is the device's own. Method: both policies on the same links, several
// courses.
TEST_CASE("motion_is_seen_sooner_where_packets_are_lost") {
  if (too_slow()) return;
  for (std::uint64_t round_trip_ms : {2, 40}) {
    CAPTURE(round_trip_ms);
    MotionOptions o;
    o.round_trip_ns = round_trip_ms * 1'000'000, o.device_ns = 16 * 46'000, o.lost_per_million = 60'000;
    o.turn_seconds = 12;
    Felt felt[2];
    for (bool drops : {false, true}) o.drops_frames = drops, felt[drops] = feel(o, round_trip_ms == 2 ? 4 : 14);
    MESSAGE("median ", felt[0].median_ms, ", ", felt[1].median_ms, " ms, 99th percentile ", felt[0].late_ms, ", ",
            felt[1].late_ms, " ms, ", felt[1].dropped, " of ", felt[1].dropped + felt[1].shown, " dropped");
    CHECK(felt[0].dropped == 0);
    CHECK(felt[1].dropped > 0);
    CHECK(felt[1].drops_in_a_row == 1);
    CHECK(felt[1].late_ms < 0.9 * felt[0].late_ms);
    CHECK(felt[1].late_ms < 3.5 * felt[1].median_ms);
    CHECK(felt[1].median_ms < 1.05 * felt[0].median_ms);
  }
}

// Goal: a button held while a server says nothing still moves the screen. Method: a server that is silent for two
// seconds, which the device bridges alone: one picture gives way, none after it until the server speaks again.
TEST_CASE("motion_goes_on_while_a_server_is_silent") {
  if (too_slow()) return;
  MotionOptions o;
  o.lost_per_million = 0, o.silence_at = 8, o.silence_for = 2;
  MotionResult results[2];
  for (bool drops : {false, true}) o.drops_frames = drops, results[drops] = run_motion(o);
  CHECK(results[1].dropped == 1);
  CHECK(results[1].gap_ms_max < 1.5 * results[0].gap_ms_max);
  CHECK(results[1].screen == results[1].own_screen);
}

// Goal: counted frames are all completed, however late. Method: a link that loses much, and a count.
TEST_CASE("motion_drops_no_counted_frame") {
  if (too_slow()) return;
  MotionOptions o;
  o.lost_per_million = 60'000, o.frame_count = 110, o.turn_seconds = 20;
  const MotionResult r = run_motion(o);
  CHECK(r.motion.total_ns > 0);  // the camera was turning
  CHECK(r.frames_dropped == 0);
  CHECK(r.frames_finished == 110);
}

// Goal: where pictures take long, coarse ones follow the camera and the picture at rest is the device's own; where they
// do not, none comes. Method: the same turns with pictures eight times as dear as those above, and as dear; with and
// without coarse pictures.
TEST_CASE("motion_is_followed_by_coarse_pictures_where_frames_are_long") {
  if (too_slow()) return;
  for (double dear : {1.0, 8.0}) {
    CAPTURE(dear);
    MotionOptions o;
    o.lost_per_million = 0, o.device_ns *= dear, o.server_ns *= dear, o.turn_seconds = 12;
    MotionResult results[2];
    for (bool coarse : {false, true}) o.coarse_first = coarse, results[coarse] = run_motion(o);
    MESSAGE("median ", results[0].ms(0.5), ", ", results[1].ms(0.5), " ms, 99th percentile ", results[0].ms(0.99), ", ",
            results[1].ms(0.99), " ms");
    for (const MotionResult& r : results) CHECK(r.screen == r.own_screen);
    CHECK(results[1].frames_dropped == 0);  // what was visible was not dropped
    if (dear == 1) CHECK(results[1].ms(0.5) == doctest::Approx(results[0].ms(0.5)).epsilon(0.01));
    if (dear > 1) CHECK(results[1].ms(0.5) < 0.1 * results[0].ms(0.5));
    if (dear > 1) CHECK(results[1].ms(0.99) < 0.2 * results[0].ms(0.99));
  }
}

// Prints the figures of tests/split_report/FIGURES.md; run by `make motion-table`.
TEST_CASE("motion_to_photon_table" * doctest::skip()) {
  std::printf(
      "| ns per pixel | round trip | lost | policy | median | 99th percentile | longest gap | shown | dropped |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  auto print = [](MotionOptions o, double device_ns, const char* policy) {
    o.width = 320, o.height = 240, o.bytes_per_second = 2'375'000;
    o.device_ns = device_ns, o.turn_seconds = 32;
    const Felt f = feel(o, o.lost_per_million > 0 ? 4 : 1);
    std::printf("| %.0f | %u ms | %u %% | %s | %.0f | %.0f | %.0f | %u | %u |\n", device_ns,
                static_cast<unsigned>(o.round_trip_ns / 1'000'000), o.lost_per_million / 10'000, policy, f.median_ms,
                f.late_ms, f.gap_ms_max, f.shown, f.dropped);
    std::fflush(stdout);
  };
  for (double device_ns : {8841.0, 46000.0})
    for (std::uint32_t lost : {0u, 10'000u})
      for (std::uint64_t round_trip_ms : {2, 40})
        for (bool drops : {false, true}) {
          MotionOptions o;
          o.server_ns = 989;
          o.round_trip_ns = round_trip_ms * 1'000'000, o.lost_per_million = lost, o.drops_frames = drops;
          print(o, device_ns, drops ? "drops" : "completes");
        }
  // 4 and 16 samples.
  for (double samples : {4.0, 16.0})
    for (std::uint32_t lost : {0u, 10'000u})
      for (std::uint64_t round_trip_ms : {2, 40})
        for (bool coarse : {false, true}) {
          MotionOptions o;
          o.server_ns = samples * 989;
          o.round_trip_ns = round_trip_ms * 1'000'000, o.lost_per_million = lost, o.coarse_first = coarse;
          print(o, samples * 8841, coarse ? "coarse first" : "drops");
        }
}
