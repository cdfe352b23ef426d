// One frame.
#pragma once
#include "engine/span_list.h"
#include "engine/trace_frame.h"

namespace pocketray {

// Poses, accelerates and lights the scene at a time and clears the tracers' counters: everything but tracing.
Status prepare_frame(Renderer* renderer, double seconds);

// Renders the frame at a time into renderer->image, as far as the source hands it out; trace_ms receives the tracing
// time.
// *complete (may be null) receives the result of trace_frame().
Status render_frame(Renderer* renderer, double seconds, const SpanSource& source, bool* complete = nullptr);

// Renders the renderer's spans, the whole frame. `stop`, if given, ends it early; *rows_done is the progress.
Status render_frame(Renderer* renderer, double seconds, Aov aov = Aov::none, const std::atomic<bool>* stop = nullptr,
                    std::uint32_t* rows_done = nullptr);

}  // namespace pocketray
