// The view of a model without a camera or lights, measured before it is baked or opened.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace pocketray {

struct MeasuredView {
  DefaultView view;
  std::vector<Framing> framings;  // as Scene has them
};

// Returns whether the scene has no camera or no light, so that its view is worth measuring.
bool needs_view(const Scene& scene);
// Measures a scene, in all poses of each of its animations, whatever view it has stored. Stores the result in the
// scene, which then points into *measured. Uses the heap.
void measure_view(Scene* scene, MeasuredView* measured);

}  // namespace pocketray
