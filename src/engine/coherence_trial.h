// Decides for CoherenceMode::automatic whether coherence pays: compares the times of frames, and rests if it does not.
#pragma once
#include <cstdint>

namespace pocketray {

// How a frame was traced: whole; whole and recorded for the next; only pixels that may have changed, recorded too.
enum class FrameKind : std::uint8_t { plain, recorded, coherent };

struct CoherenceTrial {
  bool is_cold = true;                    // no frame has been requested yet
  bool is_warming = false;                // first frame: cold caches distort its time, which is ignored
  double plain_ns = 0, recorded_ns = 0;   // time of the last frame of that kind; 0: none yet
  double credit_ns = 0;                   // saved since the last rest, at most a plain frame's time
  bool was_recorded = false;              // the last frame was recorded
  std::uint32_t rest = 0, rest_next = 1;  // frames to trace whole before the next try
  bool was_resting = false;               // during the last frame
  bool tries_again = false;               // the first try after a rest
};

// Accounts for a frame that took `ns`.
void weigh_frame(CoherenceTrial* trial, FrameKind kind, double ns);
// Used where times cannot be compared: rests unless coherence paid off.
void rest_after(CoherenceTrial* trial, bool did_pay);
// Returns whether coherence rests for the next frame, always true for the first. Call it once per frame.
bool rests(CoherenceTrial* trial);

}  // namespace pocketray
