// One frame.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Poses, accelerates and lights the scene at a time. Everything but the tracing.
Status prepare_frame(Renderer* renderer, double seconds);

// Renders the frame at a time into renderer->image. `stop`, where given, ends it early; *rows_done says how far it
// came.
Status render_frame(Renderer* renderer, double seconds, Aov aov = Aov::none, const std::atomic<bool>* stop = nullptr,
                    std::uint32_t* rows_done = nullptr);

}  // namespace pocketray
