// Vertices of an OBJ file in double, where they are far from the origin.
#pragma once
#include "import/files.h"

namespace pocketray {

struct SceneBuilder;

// Chooses the scene's origin for the tidied text, whose numbers have been checked; where there is one, rewrites the
// vertices relative to it, so that the parsing library, which rounds them to float, sees what is left. Lines keep their
// numbers.
void recentre_obj(SceneBuilder* builder, Bytes* text);

}  // namespace pocketray
