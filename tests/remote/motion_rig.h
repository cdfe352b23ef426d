// The viewer on an emulated device with one server, all on a virtual clock, and a user who turns the camera.
#pragma once
#include <vector>

#include "platform/null/net/null_link.h"
#include "viewer/viewer.h"

namespace pocketray {

struct MotionOptions {
  std::uint32_t width = 80, height = 60;
  double device_ns = 16 * 8841.0, server_ns = 16 * 989.0;  // per pixel: a picture takes as long as one of 320×240
  std::uint64_t bytes_per_second = 2'375'000 / 16, round_trip_ns = 2'000'000;
  std::uint32_t lost_per_million = 10'000;
  std::uint64_t seed = 1;
  bool drops_frames = true, coarse_first = false;
  std::uint32_t frame_count = 0;           // as in ViewOptions
  double turn_seconds = 8;                 // of which the first two do not count
  double silence_at = 0, silence_for = 0;  // seconds: the server does nothing meanwhile; 0: no such time
};

struct MotionResult {
  Motion motion;
  std::uint32_t shown = 0, dropped = 0;                   // pictures while the camera turned
  double gap_ms_max = 0, gap_ms_mean = 0;                 // between two shown
  std::uint32_t drops_in_a_row = 0;                       // at most
  std::uint32_t frames_finished = 0, frames_dropped = 0;  // in all
  std::vector<std::uint8_t> screen, own_screen;           // at rest in the end; the same as the device alone renders it
  double ms(double part) const { return latency_ns(motion, part) * 1e-6; }
};

// Shows `cornell` and turns the camera right and left in turn, each for half a second.
MotionResult run_motion(const MotionOptions& options);

}  // namespace pocketray
