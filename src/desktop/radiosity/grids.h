// Grids of nodes on flat surfaces.
#pragma once
#include "desktop/radiosity/barriers.h"
#include "desktop/radiosity/receivers.h"

namespace pocketray {

// Covers a side of a surface with a grid whose nodes are about `spacing` apart, or with several, cut apart along the
// lines of barriers.
void place_grids(const Scene& scene, const FlatSurface& flat, const std::vector<Barrier>& barriers, double spacing,
                 bool back, Places* places, RadiositySolution* solution);

// Nodes on either side of a seam get light that is the same there.
void join_seams(const std::vector<Seam>& seams, RadiositySolution* solution);

}  // namespace pocketray
