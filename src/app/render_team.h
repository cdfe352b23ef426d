// A sequence whose frames all ranks of a team render, each into its own files.
#pragma once
#include <functional>

#include "app/coherent_sequence.h"
#include "session/sequence_share.h"
#include "session/team.h"

namespace pocketray {

// A frame that a rank has rendered and written.
struct SharedFrame {
  std::uint32_t frame = 0;
  double trace_ms = 0;
  CoherentSequence coherent;  // of this frame alone; empty if it was traced whole without coherence
};

// The leader's side. It renders frames itself, and collects the helpers' results in between.
class FrameLead {
 public:
  // `identity` is equal on ranks whose pictures are equal. Calls finished() for each frame that a helper has written.
  FrameLead(const Team& team, std::string identity, std::vector<std::uint32_t> frames,
            std::function<void(const SharedFrame&)> finished);
  // Returns the leader's next frame; *there is false once all frames are written, or some remain after an interrupt.
  // Fails if a helper has.
  Status next(std::uint32_t* frame, bool* there);

 private:
  struct Helper {
    bool is_ready = false;
    std::size_t frames = 0;  // frames that it holds
  };
  Status serve_one(double seconds, bool* there);
  bool is_any_busy() const;
  void give_frames();

  const Team& team_;
  std::string identity_;
  SequenceShare share_;
  std::function<void(const SharedFrame&)> finished_;
  std::vector<Helper> helpers_;  // by rank; the leader's own is idle
};

// For helpers: reports that this rank can render.
void tell_ready_for_frames(const Team& team, const std::string& identity);
// Renders the frames in a message of the leader; `render` leaves *complete false at an interrupt.
Status render_given_frames(const Team& team, const TeamMessage& message,
                           const std::function<Status(SharedFrame*, bool* complete)>& render);

}  // namespace pocketray
