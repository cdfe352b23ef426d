#include "app/coherent_sequence.h"

#include <cinttypes>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "session/interrupt.h"

namespace pocketray {
namespace {

double share(const CoherentSequence& s) {
  return s.pixels ? static_cast<double>(s.pixels_traced) / static_cast<double>(s.pixels) : 1;
}

}  // namespace

Status render_next(Renderer* renderer, double seconds, CoherentSequence* sequence, bool* complete) {
  RETURN_IF_ERROR(render_frame(renderer, changes_at(seconds, &interrupted), complete));
  const CoherenceState& state = renderer->history.state;
  if (state.whole_because && sequence->frames > 0) sequence->whole_because = state.whole_because;
  sequence->whole_frames += state.whole_because != nullptr;
  sequence->pixels += renderer->image.count;
  sequence->pixels_traced += state.pixels_traced;
  ++sequence->frames;
  return success();
}

void add_coherence(const CoherentSequence& other, CoherentSequence* s) {
  s->frames += other.frames, s->whole_frames += other.whole_frames;
  s->pixels += other.pixels, s->pixels_traced += other.pixels_traced;
}

void print_coherence(const CoherentSequence& s) {
  if (s.frames < 2) return;
  std::printf("  coherence: %.1f %% of the pixels traced; %" PRIu64 " of %" PRIu64 " frames whole%s%s\n",
              100 * share(s), s.whole_frames, s.frames, s.whole_because ? "; latest cause: " : "",
              s.whole_because ? s.whole_because : "");
}

Json coherence_json(const CoherentSequence& s) {
  return {
      {"frames", s.frames}, {"whole_frames", s.whole_frames}, {"pixels_traced", s.pixels_traced}, {"share", share(s)}};
}

}  // namespace pocketray
