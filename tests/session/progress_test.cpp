#include "session/progress.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <string>

using namespace pocketray;

namespace {

// The estimates of work that takes 64 s and has done time^power of itself: their number, and the worst ratio to the
// truth.
struct Estimates {
  int count = 0;
  double first_share = 1, ratio_max = 1;
};
Estimates estimates_of(double power) {
  constexpr double kDuration = 64;
  TimeEstimate estimate;
  Estimates e;
  for (int step = 1; step < 640; ++step) {
    const double elapsed = step * 0.1, share = std::pow(elapsed / kDuration, power);
    const double left = seconds_left(&estimate, elapsed, share);
    if (left < 0) continue;
    if (e.count++ == 0) e.first_share = elapsed / kDuration;
    const double ratio = left / (kDuration - elapsed);
    e.ratio_max = std::fmax(e.ratio_max, std::fmax(ratio, 1 / ratio));
  }
  return e;
}

}  // namespace

// Goal: a remaining time is shown early where it is right, and not at all where it would be off by more than two.
// Method: work of even speed, and work that speeds up or slows down as a power of time.
TEST_CASE("progress_estimates_only_what_is_steady") {
  const Estimates even = estimates_of(1);
  CHECK(even.count > 580);
  CHECK(even.first_share < 0.04);
  CHECK(even.ratio_max < 1.01);
  for (double power : {0.3, 0.5, 2.0, 3.0}) {
    CAPTURE(power);
    CHECK(estimates_of(power).count == 0);
  }
  CHECK(estimates_of(1.2).ratio_max < 3);
}

// Goal: work that begins slowly gets its estimate once its speed is steady. Method: 1 % in the first 10 s, then 2 % a
// second.
TEST_CASE("progress_estimates_after_a_slow_start") {
  TimeEstimate estimate;
  int late = 0, right = 0;
  for (int step = 1; step < 590; ++step) {
    const double elapsed = step * 0.1, share = elapsed < 10 ? elapsed * 0.001 : 0.01 + (elapsed - 10) * 0.0198;
    const double left = seconds_left(&estimate, elapsed, share), truth = 60 - elapsed;
    if (left < 0) continue;
    CHECK(elapsed > 10);
    ++(left > 2 * truth || left < truth / 2 ? late : right);
  }
  CHECK(late < 100);  // until the elapsed time has doubled once more
  CHECK(right > 300);
}

// Goal: the remaining time includes work that follows. Method: closed forms, in seconds and in minutes.
TEST_CASE("progress_tells_of_later_work") {
  const auto text_of = [](double elapsed, double left, const LaterWork& later) {
    char text[kLeftTextMax];
    format_left(elapsed, left, later, text);
    return std::string(text);
  };
  CHECK(text_of(10, -1, {20, 1}) == "");
  CHECK(text_of(10, 40, {}) == ", 40 s left");
  CHECK(text_of(10, 40, {20, 0}) == ", 40 s left, about 60 s in all");
  CHECK(text_of(10, 40, {30, 0.25}) == ", 40 s left, about 82 s in all");
  CHECK(text_of(60, 60, {0, 1}) == ", 60 s left, about 3 min in all");
}
