// Leaves out what no picture of a scene shows (scene/invisible.h), so that no device stores it or asks for it.
#pragma once
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Views of the arrays.
Scene view_of(const SceneArrays& arrays);

// Reduces a valid scene whose vertices are posed. SceneArrays::reductions counts what is left out, for `plan`. Pictures
// keep their bits, but for the following:
//   - a folded texture tightens the bounds by which rays are skipped;
//   - a lamp whose texture is folded gets the closed form of one without;
//   - normals within rounding of those of inclined faces become these;
//   - rays through glass of index 1 no longer begin anew at its surfaces, and the default camera frames what is left.
void reduce(SceneArrays* arrays);

}  // namespace pocketray
