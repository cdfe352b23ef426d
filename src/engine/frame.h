// One frame.
#pragma once
#include "engine/span_list.h"
#include "engine/trace_frame.h"

namespace pocketray {

// Poses, accelerates and lights the scene at a time and clears the tracers' counts. Everything but the tracing.
Status prepare_frame(Renderer* renderer, double seconds);

// Renders the frame at a time into renderer->image, whatever of it the source hands out; tracing is timed in trace_ms.
// *complete, which may be null: as trace_frame() returns it.
Status render_frame(Renderer* renderer, double seconds, const SpanSource& source, bool* complete = nullptr);

// The same for the renderer's spans, the whole frame. `stop`, where given, ends it early; *rows_done says how far it
// came.
Status render_frame(Renderer* renderer, double seconds, Aov aov = Aov::none, const std::atomic<bool>* stop = nullptr,
                    std::uint32_t* rows_done = nullptr);

}  // namespace pocketray
