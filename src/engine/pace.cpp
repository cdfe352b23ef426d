#include "engine/pace.h"

#include <chrono>
#include <thread>

#include "base/check.h"

namespace pocketray {
namespace {

// Less is left to the next wait: a sleep overruns by a quarter of this, Linux's timer slack of 50 µs [prctl(2)].
constexpr std::int64_t kOwedNsMax = 200'000;
// Chosen: three display frames, about the time that other programs take now and then; a stop within about a display
// frame; and beyond any frame, so that sums stay far from overflow.
constexpr std::int64_t kExcessNsMax = 50'000'000;  // more is not made up for: this CPU is too slow for the pace
constexpr std::int64_t kSleepNsMax = 20'000'000;   // between two checks of `stop`
constexpr double kPacedNsMax = 3600e9;             // maximum wait

std::uint64_t to_ns(double ns) { return static_cast<std::uint64_t>(ns < kPacedNsMax ? ns : kPacedNsMax); }

void sleep_ns(std::uint64_t duration) { std::this_thread::sleep_for(std::chrono::nanoseconds(duration)); }

}  // namespace

const Clock kSystemClock = {clock_ns, sleep_ns};

std::uint64_t paced_ns(const Pace& pace, std::uint64_t pixel_count, std::uint64_t elapsed_ns) {
  if (pace.ns_per_pixel > 0) return to_ns(static_cast<double>(pixel_count) * pace.ns_per_pixel);
  return pace.slowdown > 1 ? to_ns(static_cast<double>(elapsed_ns) * pace.slowdown) : elapsed_ns;
}

std::uint64_t paced_prepare_ns(const Pace& pace, std::uint64_t elapsed_ns) {
  return pace.ns_per_pixel > 0 ? to_ns(pace.prepare_ns) : paced_ns(pace, 0, elapsed_ns);
}

void pace_spans(const Pace& pace, const Span* spans, std::uint32_t span_count, std::uint32_t thread_count,
                std::uint64_t* span_ns) {
  CHECK_GE(thread_count, 1u);
  CHECK(span_count == 0 || (spans != nullptr && span_ns != nullptr));
  for (std::uint32_t i = 0; i < span_count; ++i) {
    std::uint64_t each = paced_ns(pace, span_pixel_count(&spans[i], 1), span_ns[i]);
    span_ns[i] = pace.ns_per_pixel > 0 ? each * thread_count : each;
  }
}

std::uint64_t span_pixel_count(const Span* spans, std::uint32_t span_count) {
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < span_count; ++i) count += std::uint64_t(spans[i].column_end - spans[i].column_begin);
  return count;
}

void wait_for_pace(Pace* pace, std::uint64_t pixel_count, std::uint64_t start_ns, const std::atomic<bool>* stop) {
  if (!is_paced(*pace)) return;
  std::uint64_t last = pace->clock->now_ns();
  pace->owed_ns += static_cast<std::int64_t>(paced_ns(*pace, pixel_count, last - start_ns)) -
                   static_cast<std::int64_t>(last - start_ns);
  auto stopped = [&] {
    return (stop && stop->load(std::memory_order_relaxed)) ||
           (pace->stop && pace->stop->load(std::memory_order_relaxed));
  };
  while (pace->owed_ns > kOwedNsMax && !stopped()) {
    std::int64_t sleep = pace->owed_ns - kOwedNsMax / 2;
    pace->clock->sleep_ns(static_cast<std::uint64_t>(sleep < kSleepNsMax ? sleep : kSleepNsMax));
    std::uint64_t now = pace->clock->now_ns();
    pace->owed_ns -= static_cast<std::int64_t>(now - last);
    last = now;
  }
  if (pace->owed_ns > kOwedNsMax) pace->owed_ns = 0;
  if (pace->owed_ns < -kExcessNsMax) pace->owed_ns = -kExcessNsMax;
}

}  // namespace pocketray
