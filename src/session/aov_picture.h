// AOVs as displayable pictures: false colours and a legend.
#pragma once
#include "present/false_color.h"
#include "session/picture.h"
#include "shade/trace_spans.h"

namespace pocketray {

struct AovPicture {
  Legend legend;         // empty if there is no room
  char told[160] = {0};  // the legend in words, one line; empty: nothing to explain
};

// Replaces the values of the box in renderer->image by colours, and the exposure by 1. Cost: viridis from 0 to the
// maximum; triangle: one colour each; normal and position: x, y and z as red, green and blue; depth: grey, the farthest
// white.
AovPicture color_aov(Aov aov, const PixelBox& box, Renderer* renderer);

}  // namespace pocketray
