// Cells of 4 × 4 pixels: what their traced corners tell of the pixels between them; see selective.h.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr std::uint32_t kCellSide = 4;

// A traced pixel at a corner of cells.
struct CellCorner {
  Vec3 radiance;
  Vec3 diffuse, glow, normal;  // of the surface there
  const Material* material;    // null: the background
  bool is_smooth;              // see has_smooth_light(); true for the background
  bool known = false;
};

struct PixelCell {
  const CellCorner* corner[4];  // left and right above, then below
  float across, down;           // one pixel's share of the cell's sides
};

// Whether light that leaves the first surface along a ray changes no faster than its lighting: it is no mirror, glass,
// hole or face that the ray passes, and no body about the camera absorbs.
bool has_smooth_light(const FrameData& frame, const Surface& s);

// Whether the whole cell is a plain surface, or background, at hardly any contrast: less than `contrast`, the frame's
// Selection::contrast or what a moving cell may have.
bool is_flat(const FrameData& frame, const PixelCell& cell, float contrast);

// The radiance that corners on the same surface predict for a pixel, `column` and `row` of the cell. False if fewer
// than two are, or they disagree.
bool predict(const FrameData& frame, const PixelCell& cell, float contrast, const Surface& s, std::uint32_t column,
             std::uint32_t row, Vec3* radiance);

}  // namespace pocketray
