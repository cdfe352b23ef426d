// The area lights of a scene: its emissive materials, those with few flat pieces piece by piece.
#pragma once
#include "scene/scene.h"

namespace pocketray {

struct Lamp {
  std::uint32_t material;
  std::uint32_t piece;  // a triangle in whose plane the others are, at time 0; kNone: all triangles of the material
  std::uint32_t begin, end;  // range of the triangles among which its own are
};

// Divided, so that each piece has a polygon: materials of two to kPiecesMax planes whose triangles rest; of them,
// convex bodies of more than kConvexPiecesMax, such as bulbs, are not, whose pieces do not light each other. If that
// would make more lamps than there can be whatever the points of each, no material is divided.
constexpr std::uint32_t kPiecesMax = 16, kConvexPiecesMax = 6;  // chosen: a box
constexpr std::uint32_t kDividedLampsMax = 16;

struct LampPieces {
  Lamp piece[kDividedLampsMax];  // in the order of their first triangles
  std::uint32_t count = 0;       // 0: no material is divided
};

// Where materials are lamps as `materials` says, which has one for each of the scene's. O(triangles).
LampPieces find_lamp_pieces(const Scene& scene, Array<const Material> materials);

// Whether a triangle of the scene is a part of the lamp.
bool is_part_of(const Scene& scene, const Lamp& lamp, std::uint32_t triangle);

inline bool is_emissive(const Material& m) { return !is_zero(m.emission); }

// Visits the lamps in the order of their materials.
template <class Visit>
void each_lamp(const Scene& scene, Array<const Material> materials, Visit visit) {
  const LampPieces pieces = find_lamp_pieces(scene, materials);
  for (std::uint32_t m = 0; m < materials.count; ++m) {
    if (!is_emissive(materials[m])) continue;
    bool is_divided = false;
    for (std::uint32_t i = 0; i < pieces.count; ++i)
      if (pieces.piece[i].material == m) visit(pieces.piece[i]), is_divided = true;
    if (!is_divided) visit(Lamp{m, kNone, 0, scene.triangles.count});
  }
}

}  // namespace pocketray
