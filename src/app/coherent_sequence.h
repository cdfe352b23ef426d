// Savings by coherence over a sequence of frames.
#pragma once
#include "engine/frame.h"
#include "session/report.h"
#include "session/scene_options.h"

namespace pocketray {

struct CoherentSequence {
  std::uint64_t frames = 0, whole_frames = 0, pixels = 0, pixels_traced = 0;
  const char* whole_because = nullptr;  // why the last frame after the first was traced whole; null: none was
};

// Renders the changes of the next frame; an interrupt ends it early.
Status render_next(Renderer* renderer, double seconds, CoherentSequence* sequence, bool* complete);

// Adds the savings of another process in frames of the same sequence.
void add_coherence(const CoherentSequence& other, CoherentSequence* sequence);

void print_coherence(const CoherentSequence& sequence);
Json coherence_json(const CoherentSequence& sequence);

}  // namespace pocketray
