// The CPU speed of an emulated device: work takes as long as it would there. The results stay equal, bit for bit.
#pragma once
#include <atomic>

#include "base/span.h"
#include "engine/workers.h"

namespace pocketray {

// A clock and its sleep function: the system's or a test's.
struct Clock {
  std::uint64_t (*now_ns)();
  void (*sleep_ns)(std::uint64_t duration);
};
extern const Clock kSystemClock;  // clock_ns()

struct Pace {
  double slowdown = 1;                      // time on the device over time here, per thread; at least 1
  double ns_per_pixel = 0;                  // > 0: fixed cost of a pixel on the device, replacing `slowdown`
  double prepare_ns = 0;                    // with it: time before a frame's first pixel: pose, refit
  const char* device = nullptr;             // name for display; null: none
  const std::atomic<bool>* stop = nullptr;  // set: the user wants to quit, so waits end
  const Clock* clock = &kSystemClock;       // times frames, paced or not
  std::int64_t owed_ns = 0;                 // of wait_for_pace(): time still to wait, or in excess if negative
};

inline bool is_paced(const Pace& pace) { return pace.slowdown > 1 || pace.ns_per_pixel > 0; }

// Device time of work on that many pixels that took `elapsed_ns` here. Pure: for callers that wait by themselves.
std::uint64_t paced_ns(const Pace& pace, std::uint64_t pixel_count, std::uint64_t elapsed_ns);
// Device time of preparing a frame.
std::uint64_t paced_prepare_ns(const Pace& pace, std::uint64_t elapsed_ns);
// Converts the spans' costs from this machine to the device; `thread_count` threads traced them.
void pace_spans(const Pace& pace, const Span* spans, std::uint32_t span_count, std::uint32_t thread_count,
                std::uint64_t* span_ns);
std::uint64_t span_pixel_count(const Span* spans, std::uint32_t span_count);

// Waits until work on that many pixels, begun at `start_ns` by the clock, has taken its device time, to about 0.2 ms;
// the next wait of the frame makes up for the difference. `stop`, if given, ends the wait.
void wait_for_pace(Pace* pace, std::uint64_t pixel_count, std::uint64_t start_ns,
                   const std::atomic<bool>* stop = nullptr);

}  // namespace pocketray
