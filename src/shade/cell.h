// Predicts the pixels of 4 × 4 cells from the cells' traced corners; see selective.h.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr std::uint32_t kCellSide = 4;

// A traced pixel at a corner of cells.
struct CellCorner {
  Vec3 radiance;
  Vec3 diffuse, glow, normal;  // of the surface hit
  const Material* material;    // null: the background
  bool is_smooth;              // see has_smooth_light(); true for the background
  bool known = false;
};

struct PixelCell {
  const CellCorner* corner[4];  // left and right above, then below
  float across, down;           // size of a pixel relative to the cell's sides
};

// Returns whether light leaving the surface at a first hit varies as slowly as its lighting: it is not a mirror, glass,
// a hole or a face that the ray passes through, and the camera is not inside an absorbing body.
bool has_smooth_light(const FrameData& frame, const Surface& s);

// Returns whether the whole cell shows one plain surface, or background, with less contrast than `contrast`: the
// frame's Selection::contrast, or the limit for a moving cell.
bool is_flat(const FrameData& frame, const PixelCell& cell, float contrast);

// Predicts the radiance of the pixel at `column` and `row` of the cell from corners on the same surface. Returns false
// if there are fewer than two such corners or they disagree.
bool predict(const FrameData& frame, const PixelCell& cell, float contrast, const Surface& s, std::uint32_t column,
             std::uint32_t row, Vec3* radiance);

}  // namespace pocketray
