// Whether coherence pays, of CoherenceMode::automatic: compares the times of frames, and rests where it does not.
#pragma once
#include <cstdint>

namespace pocketray {

// How a frame was traced: whole; whole, and recorded for the next; only the pixels that may have changed, recorded too.
enum class FrameKind : std::uint8_t { plain, recorded, coherent };

struct CoherenceTrial {
  bool is_cold = true;                    // no frame has been asked for
  bool is_warming = false;                // the first frame: its time is that of cold caches, and tells nothing
  double plain_ns = 0, recorded_ns = 0;   // the last frame of the kind; 0: none yet
  double credit_ns = 0;                   // saved since the last rest, at most a plain frame's time
  bool was_recorded = false;              // the last frame, whole
  std::uint32_t rest = 0, rest_next = 1;  // frames to trace whole before coherence is tried again
  bool was_resting = false;               // for the last frame
  bool tries_again = false;               // after a rest
};

// Weighs a frame that took `ns`.
void weigh_frame(CoherenceTrial* trial, FrameKind kind, double ns);
// Where times cannot be compared: coherence paid, or it did not and rests.
void rest_after(CoherenceTrial* trial, bool did_pay);
// Whether coherence rests for the next frame: always for the first. Call it once for each.
bool rests(CoherenceTrial* trial);

}  // namespace pocketray
