// Values at the corners of triangles that belong to no flat surface, and of the parts of large ones.
#pragma once
#include "desktop/radiosity/receivers.h"

namespace pocketray {

// Halves triangles at the middle of their longest edge [Rivara 1984, "Algorithms for refining triangular grids suitable
// for adaptive and multigrid techniques"] until no edge is longer than `edge_max`. Whether an edge is divided depends
// on its length alone, so neighbours agree on it, and nowhere does a corner of one lie on the edge of another. Corners
// share a value where position and normal agree: continuity of the normal decides [Bastos92].
void place_corners(const Scene& scene, const Surfaces& surfaces, double edge_max, bool back,
                   const std::vector<char>& sees, Places* places, RadiositySolution* solution);

// Values that lie inside bodies (not `known`) take the mean of their neighbours, from the outside in.
void fill_covered_values(const Scene& scene, std::vector<char>* known, RadiositySolution* solution);

}  // namespace pocketray
