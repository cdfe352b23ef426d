// Motion to photon: the lag of the screen behind the buttons that move the camera. A held button counts at every
// moment, so the figures do not depend on how often buttons are read; a press that moves the camera at once counts as a
// millisecond. The photon is the end of the first screen update after which the whole screen, possibly coarse, shows
// pictures whose camera includes that moment: rows of a picture in parts count once the last of them is shown, those of
// a dropped picture never. Fixed memory.
#pragma once
#include <cstdint>

namespace pocketray {

// A period in which buttons moved the camera.
struct MotionSpan {
  std::uint64_t begin_ns = 0, end_ns = 0;
};

constexpr std::uint32_t kMotionSpansMax = 32;  // not yet shown; beyond it, gaps between the newest count as motion
// Latencies from 2^10 ns upward, 64 parts per octave: within 1.6 %. The last part collects longer ones.
constexpr std::uint32_t kLatencyOctaveMin = 10, kLatencyOctaves = 27, kLatencyParts = 64;
constexpr std::uint32_t kLatencyCount = kLatencyOctaves * kLatencyParts;

struct Motion {
  MotionSpan spans[kMotionSpansMax];  // oldest first
  std::uint32_t span_count = 0;
  std::uint32_t taken_count = 0;                    // number of oldest spans that the current picture includes
  std::uint64_t ns_by_latency[kLatencyCount] = {};  // time of motion
  std::uint64_t total_ns = 0;
  std::uint64_t noted_ns = 0;  // end of the latest motion
};

// Notes that buttons moved the camera from `begin_ns` until `end_ns`, which is now by the screen's clock.
void note_motion(Motion* motion, std::uint64_t begin_ns, std::uint64_t end_ns);
// Notes the begin of a picture whose camera includes all motion so far.
void take_motion(Motion* motion);
// Notes that the whole screen shows the picture since `now_ns`.
void show_motion(Motion* motion, std::uint64_t now_ns);
// Drops motion that is not shown yet, but no figures.
void drop_motion(Motion* motion);

// Returns the latency in nanoseconds that a fraction of the motion, from 0 to 1, stayed within; 0 without motion.
double latency_ns(const Motion& motion, double part);

}  // namespace pocketray
