// Motion to photon: how long the screen lags behind the buttons that move the camera. A held button counts at every
// moment, so the figures do not depend on how often buttons are read; a press that moves the camera at once counts as a
// millisecond. The photon is the end of the first screen update after which the whole screen, possibly coarse, shows
// pictures whose camera includes that moment: rows of a picture in parts count once the last of them is shown, and
// those of a dropped one never. Fixed memory.
#pragma once
#include <cstdint>

namespace pocketray {

// A time during which buttons moved the camera.
struct MotionSpan {
  std::uint64_t begin_ns = 0, end_ns = 0;
};

constexpr std::uint32_t kMotionSpansMax = 32;  // not shown yet; beyond, gaps between the newest count as motion
// Latencies from 2^10 ns upward, each octave in 64 parts: to within 1.6 %. The last part takes what is longer.
constexpr std::uint32_t kLatencyOctaveMin = 10, kLatencyOctaves = 27, kLatencyParts = 64;
constexpr std::uint32_t kLatencyCount = kLatencyOctaves * kLatencyParts;

struct Motion {
  MotionSpan spans[kMotionSpansMax];  // oldest first
  std::uint32_t span_count = 0;
  std::uint32_t taken_count = 0;                    // of these, the first, that the picture under way includes
  std::uint64_t ns_by_latency[kLatencyCount] = {};  // time of motion
  std::uint64_t total_ns = 0;
  std::uint64_t noted_ns = 0;  // end of the latest motion
};

// Buttons moved the camera from `begin_ns` until `end_ns`, by the screen's clock, which is now.
void note_motion(Motion* motion, std::uint64_t begin_ns, std::uint64_t end_ns);
// A picture is begun whose camera includes all motion so far.
void take_motion(Motion* motion);
// The whole screen shows the picture since `now_ns`.
void show_motion(Motion* motion, std::uint64_t now_ns);
// Forgets motion that is not shown yet, but no figures.
void drop_motion(Motion* motion);

// The latency in nanoseconds that a part of the motion, from 0 to 1, was within; 0 without any motion.
double latency_ns(const Motion& motion, double part);

}  // namespace pocketray
