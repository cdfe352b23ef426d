// Decide which candidate hits count, and for which rays. A filter is set only if the plan has its effect.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Context of the shadow filters.
struct ShadowContext {
  const FrameData* frame;
  const LightPoint* emitter;  // point of an area light whose own flat piece casts no shadow; null: none
};

// Sets the frame's filters for its mask: visible (holes are cut out), opaque (accepts what blocks all light) and clear
// (accepts what transmits some). The frame must not move afterwards.
void make_filters(FrameData* frame);

}  // namespace pocketray
