// Models whose Z axis points up.
#pragma once
#include "import/scene_builder.h"

namespace pocketray {

// The transform that makes options.up, or else `format_up`, the Y axis; a remark names the turn that is not asked for.
Transform upright(SceneBuilder* builder, UpAxis format_up, const char* format);

}  // namespace pocketray
