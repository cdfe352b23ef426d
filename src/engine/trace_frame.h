// The frame loop.
#pragma once
#include "engine/renderer.h"
#include "engine/span_source.h"

namespace pocketray {

// Traces what the source hands out into renderer->image, until the frame is complete (true), or the deadline has passed
// or the stop is set (false); it goes on where it left off when called again. prepare_frame() has been called, unless
// the source hands out nothing but empty batches.
bool trace_frame(Renderer* renderer, const SpanSource& source);

}  // namespace pocketray
