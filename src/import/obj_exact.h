// Vertices of an OBJ file in double, where they are far from the origin.
#pragma once
#include <vector>

#include "import/files.h"

namespace pocketray {

struct SceneBuilder;

// Chooses the scene's origin for the tidied text, whose numbers have been checked; where there is one, replaces the
// vertices, three floats each in the text's order, by what is left of them.
void recentre_obj(const Bytes& text, SceneBuilder* builder, std::vector<float>* vertices);

}  // namespace pocketray
