// Where light is stored: the nodes of grids on flat surfaces, and the corners of other triangles and their parts.
#pragma once
#include "desktop/radiosity/rays.h"
#include "desktop/radiosity/surfaces.h"
#include "session/radiosity_solver.h"

namespace pocketray {

struct NodePlace {
  std::uint32_t node;
  Receiver at;
  std::uint32_t material;
};
struct ValuePlace {
  std::uint32_t value;
  Receiver at;
  std::uint32_t material;
};

// A node beside a cut where nothing stands, and a point beyond it whose light is to be the same.
struct Seam {
  std::uint32_t node;
  std::uint32_t place;  // as in RadiositySolution::triangles
  Vec3d beyond;
};

struct Places {
  std::vector<NodePlace> nodes;
  std::vector<ValuePlace> values;
  std::vector<Seam> seams;
};

// Fills the solution's triangles, grids and corners, makes its nodes and values, and lists where they lie. Nodes at or
// beyond a border are moved inward. Sides for which `sees_light` is false store nothing.
Places place_receivers(const Scene& scene, const Surfaces& surfaces, const RadiosityOptions& options,
                       const std::vector<char>& front_sees, const std::vector<char>& back_sees,
                       RadiositySolution* solution);

}  // namespace pocketray
