// Models whose Z axis points up.
#pragma once
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Returns the transform that makes options.up, or else `format_up`, the Y axis; a remark names an unrequested turn.
Transform upright(SceneBuilder* builder, UpAxis format_up, const char* format);

}  // namespace pocketray
