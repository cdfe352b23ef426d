// Checks what assimp's PLY reader trusts: element counts and face lists.
#pragma once
#include "import/files.h"

namespace pocketray {

// Throws an ImportError if a PLY file states more elements than it can hold, or if a face has no corners, a negative
// number, more than the file holds, or a missing vertex. The reader checks everything else.
void check_ply(const Bytes& bytes);

}  // namespace pocketray
