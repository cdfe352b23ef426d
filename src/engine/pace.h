// The CPU of an emulated device: work takes as long as it would there. Its results stay the same, bit for bit.
#pragma once
#include "engine/workers.h"

namespace pocketray {

// Time, and how to let it pass: the system's, or a test's.
struct Clock {
  std::uint64_t (*now_ns)();
  void (*sleep_ns)(std::uint64_t duration);
};
extern const Clock kSystemClock;  // clock_ns()

struct Pace {
  double slowdown = 1;           // time on the device over time here, of one thread each; at least 1
  double ns_per_pixel = 0;       // > 0: what a pixel costs the device, whatever it costs here; `slowdown` is not used
  const char* device = nullptr;  // whose it is, to be shown; null: none
  const std::atomic<bool>* stop = nullptr;  // set: the user wants to leave, nothing waits any more
  const Clock* clock = &kSystemClock;       // times frames, paced or not
  std::int64_t owed_ns = 0;                 // wait_for_pace()'s: what has yet to be waited for, or was in excess
};

inline bool is_paced(const Pace& pace) { return pace.slowdown > 1 || pace.ns_per_pixel > 0; }

// How long work on so many pixels is to take that took `elapsed_ns` here. Pure: for those who wait by themselves.
std::uint64_t paced_ns(const Pace& pace, std::uint64_t pixel_count, std::uint64_t elapsed_ns);
// Makes of what spans cost here what they cost the device; `thread_count`: of the threads that traced them.
void pace_spans(const Pace& pace, const Span* spans, std::uint32_t span_count, std::uint32_t thread_count,
                std::uint64_t* span_ns);
std::uint64_t span_pixel_count(const Span* spans, std::uint32_t span_count);

// Waits until work on so many pixels, begun at `start_ns` by the clock, has taken its time: to about 0.2 ms, and what
// was too little or too much is made up for by the next wait of the frame. `stop`, where given, ends the wait.
void wait_for_pace(Pace* pace, std::uint64_t pixel_count, std::uint64_t start_ns,
                   const std::atomic<bool>* stop = nullptr);

}  // namespace pocketray
