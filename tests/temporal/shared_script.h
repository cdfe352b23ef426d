// Frames of which a renderer traces a part of the rows, as a device or a server does: random ranges, in random batches
// and parts, sometimes given up.
#pragma once
#include "base/rng.h"
#include "engine/shared_rows.h"

namespace pocketray {

struct SharedScript {
  std::uint32_t boundary = 0;                             // moves slowly from frame to frame
  bool below = false;                                     // whether the rows below it are this renderer's
  std::uint64_t rows = 0, pixels = 0, pixels_traced = 0;  // finished
};

// Renders a part of the frame; true if every finished row equals that of `whole`, which has rendered the same frame.
bool follow_shared(Renderer* renderer, const Renderer& whole, double seconds, Rng* rng, SharedScript* script);

}  // namespace pocketray
