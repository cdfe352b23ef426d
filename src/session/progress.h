// Progress on stderr for work longer than a second: a bar with an estimate on a terminal, otherwise an occasional line.
// Allocates nothing.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace pocketray {

// Predicts the remaining time of work whose speed may change, such as a solver that refines its problem first.
struct TimeEstimate {
  double since_seconds = 0, since_share = 0;  // start of the current time window
  double speed = 0;                           // share per second in the last window
  bool is_steady = false;
};
// Returns the remaining seconds after `elapsed` seconds and a share in (0, 1] of the work, or
// a negative number while the speed still changes by more than a fifth between windows.
// Windows grow with the elapsed time. Call it often.
double seconds_left(TimeEstimate* estimate, double elapsed, double share);

// Estimate of the work that follows: a time, and a multiple of the time that the work before it takes. None if both are
// 0.
struct LaterWork {
  double seconds = 0, share = 0;
};

struct Progress {
  const char* what = "";
  LaterWork later;
  std::uint64_t total = 0;
  std::uint64_t start_ns = 0, shown_ns = 0;
  TimeEstimate estimate;
  bool terminal = false, shown = false;
};

Progress start_progress(const char* what, std::uint64_t total);
// Writes the remaining time as a person would say it, with that of everything if there is later work: "40 s left, about
// 3 min in all"; nothing while `left`, of `elapsed` and more seconds, is unknown, which is negative.
constexpr std::size_t kLeftTextMax = 64;
void format_left(double elapsed, double left, const LaterWork& later, char (&text)[kLeftTextMax]);
// Call as often as you like; prints at most ten times per second (terminal) or every ten seconds.
void show_progress(Progress* progress, std::uint64_t done);
// Clears the bar.
void end_progress(Progress* progress);

}  // namespace pocketray
