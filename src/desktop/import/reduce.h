// Leaves out what no picture of a scene shows (scene/invisible.h), so that no device stores it or asks for it.
#pragma once
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Views of the arrays.
Scene view_of(const SceneArrays& arrays);

// Reduces a valid scene whose vertices are posed. Pictures keep their bits, except that a folded texture tightens the
// bounds by which rays are skipped. SceneArrays::reductions counts what is left out, for `plan`.
void reduce(SceneArrays* arrays);

}  // namespace pocketray
