// What assimp's PLY reader takes at its word is looked at first: counts of elements, and the lists of faces.
#pragma once
#include "import/files.h"

namespace pocketray {

// Throws an ImportError where a PLY file promises more elements than it can hold, or where a face has no corners, a
// negative number of them, more than the file holds, or a vertex that does not exist. All else is left to the reader.
void check_ply(const Bytes& bytes);

}  // namespace pocketray
