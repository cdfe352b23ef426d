// The area lights of a scene: its emissive materials, divided into pieces if these are few and flat.
#pragma once
#include "scene/scene.h"

namespace pocketray {

struct Lamp {
  std::uint32_t material;
  std::uint32_t piece;  // a triangle in the plane of all the others, at time 0; kNone: all triangles of the material
  std::uint32_t begin, end;  // range that contains the lamp's triangles
};

// Materials of two to kPiecesMax planes whose triangles rest are divided, so that each piece has a polygon. Exempt are
// convex bodies of more than kConvexPiecesMax pieces, such as bulbs, whose pieces do not light each other. If the lamps
// would exceed the limit at any number of points each, no material is divided.
constexpr std::uint32_t kPiecesMax = 16, kConvexPiecesMax = 6;  // chosen: a box
constexpr std::uint32_t kDividedLampsMax = 16;

struct LampPieces {
  Lamp piece[kDividedLampsMax];  // in the order of their first triangles
  std::uint32_t count = 0;       // 0: no material is divided
};

// Finds the pieces of lamps whose emission is in `materials`, one for each of the scene's materials. O(triangles).
LampPieces find_lamp_pieces(const Scene& scene, Array<const Material> materials);

// Returns the lamp of all triangles of a material.
Lamp undivided_lamp(const Scene& scene, std::uint32_t material);

// Returns whether a triangle of the lamp's material lies in the plane of its piece.
bool is_of_piece(const Scene& scene, const Lamp& lamp, std::uint32_t triangle);
// Returns whether a triangle of the scene belongs to the lamp.
inline bool is_part_of(const Scene& scene, const Lamp& lamp, std::uint32_t triangle) {
  if (triangle < lamp.begin || triangle >= lamp.end || scene.triangles[triangle].material() != lamp.material)
    return false;
  return lamp.piece == kNone || is_of_piece(scene, lamp, triangle);
}

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
    if (!is_divided) visit(undivided_lamp(scene, m));
  }
}

}  // namespace pocketray
