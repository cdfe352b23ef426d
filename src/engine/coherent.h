// Frames that trace only what may have changed since the last one.
#pragma once
#include "engine/frame.h"

namespace pocketray {

// Sets up the renderer's coherence, if planned; a step of build_renderer().
void make_coherent(Renderer* renderer);

// Renders the frame at a time as render_frame() does, bit for bit, but traces only the pixels that can differ from the
// last frame rendered this way, as far as the settings and the memory plan allow. renderer->coherence_state describes
// what was traced. `stop`, if given, ends it early; *complete (may be null) receives whether it finished.
Status render_coherent(Renderer* renderer, double seconds, const std::atomic<bool>* stop = nullptr,
                       bool* complete = nullptr);

// Renders a coherent frame in steps, after prepare_frame(): begins a frame; then traces until about `deadline_ns` by
// the pace's clock, and returns true when it is complete.
struct CoherentFrame {
  SpanList list;
  std::uint32_t tile_row = 0;  // the next to list
  bool all = false;            // trace all pixels of the frame
  bool records = false;
  std::uint64_t spent_ns = 0;
};
void begin_coherent(Renderer* renderer, CoherentFrame* frame);
bool advance_coherent(Renderer* renderer, std::uint64_t deadline_ns, const std::atomic<bool>* stop,
                      CoherentFrame* frame);
// Ends the frame as advance_coherent() would, after another source traced each pixel of the whole frame once.
void finish_coherent(Renderer* renderer, CoherentFrame* frame);

// Starts following the frame, including one in parts, unless coherence is not planned or rests; state->whole_because is
// the reason if all of its rows must be traced. Returns true if the frame is followed and can be kept.
bool begin_following(Renderer* renderer);

}  // namespace pocketray
