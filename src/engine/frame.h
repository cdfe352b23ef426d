// One frame.
#pragma once
#include "engine/trace_frame.h"

namespace pocketray {

// Ends the last frame; poses, accelerates and lights the scene at the task's time, clears the tracers' counters and
// finds what must be traced for its purpose: everything but tracing, which is up to trace_frame().
Status begin_frame(Renderer* renderer, const FrameTask& task);

// Ends the frame in progress, if any, and keeps of it what the next may be built on: a frame of changes if it is
// complete, finished rows of a shared frame. Needed only to do so before the next frame begins.
void end_frame(Renderer* renderer);

// The frame's own spans, all of them or those that may have changed, for frames not shared.
SpanSource frame_source(Renderer* renderer, const std::atomic<bool>* stop = nullptr,
                        std::uint64_t deadline_ns = kNoDeadline);

// Renders a frame into renderer->image, as far as its source hands it out. *complete (may be null) receives the result
// of trace_frame(). A frame of changes equals the whole frame, bit for bit; history.state describes what was traced.
Status render_frame(Renderer* renderer, const FrameTask& task, bool* complete = nullptr);

// Renders the renderer's spans, the whole frame. `stop`, if given, ends it early; *rows_done is the progress.
Status render_frame(Renderer* renderer, double seconds, Aov aov = Aov::none, const std::atomic<bool>* stop = nullptr,
                    std::uint32_t* rows_done = nullptr);

}  // namespace pocketray
