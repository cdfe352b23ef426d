// A sequence whose frames all ranks of a team render, each into files of its own.
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
  CoherentSequence coherent;  // of this frame alone; nothing if it was traced whole without coherence
};

// The leader's side. It renders frames itself, and hears of the helpers' in between.
class FrameLead {
 public:
  // `identity` is equal on ranks whose pictures are. finished() is called for each frame that a helper has written.
  FrameLead(const Team& team, std::string identity, std::vector<std::uint32_t> frames,
            std::function<void(const SharedFrame&)> finished);
  // The leader's next frame; *there is false once all frames are written, or some are left after an interrupt. Fails if
  // a helper has.
  Status next(std::uint32_t* frame, bool* there);

 private:
  struct Helper {
    bool is_ready = false;
    std::size_t frames = 0;  // that it has
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

// For helpers, when they can render.
void tell_ready_for_frames(const Team& team, const std::string& identity);
// Renders the frames that a message of the leader gives; `render` leaves *complete false at an interrupt.
Status render_given_frames(const Team& team, const TeamMessage& message,
                           const std::function<Status(SharedFrame*, bool* complete)>& render);

}  // namespace pocketray
