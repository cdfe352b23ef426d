// Which candidate hits count, and for what. A filter is set only where the plan has its effect.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// What the shadow filters need to know.
struct ShadowContext {
  const FrameData* frame;
  std::uint32_t emitter;  // material of the light's own surface, which casts no shadow of itself; kNone: none
};

// Fills the frame's filters for its mask: visible (holes are cut out), opaque (what blocks light altogether) and clear
// (what lets some light through). The frame must not move afterwards.
void make_filters(FrameData* frame);

}  // namespace pocketray
