// The frame loop.
#pragma once
#include "engine/renderer.h"
#include "engine/span_source.h"

namespace pocketray {

// Traces the source's spans into renderer->image until the frame is complete (true), or the deadline has passed or the
// stop flag is set (false). The next call continues where this one ended. Call begin_frame() first, unless the source
// hands out only empty batches. Ends a complete frame of changes; timings.trace_ms receives the time since the frame
// was prepared, without pauses between calls.
bool trace_frame(Renderer* renderer, const SpanSource& source);

}  // namespace pocketray
