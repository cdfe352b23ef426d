// Materials that were recoloured or textured anew since the last frame, and the pixels that this changes: those whose
// first hits show them, and those whose shadow rays, or camera rays through holes, they stop otherwise. Rays behind
// mirrors, and all that passed transparent surfaces, are in the tables.
#pragma once
#include "temporal/tile_changes.h"

namespace pocketray {

// What changed of a material.
enum RecolorMark : std::uint8_t {
  kShownMark = 1,    // anything
  kGivenMark = 2,    // where it takes diffuse light: pixels then give other light to those about them
  kStoppedMark = 4,  // which rays it stops
  kInsideMark = 8,   // what its inside absorbs
};

constexpr std::uint32_t kRecoloredGroups = 64;

// Four groups of triangles, each next to each other in the scene.
struct RecoloredGroups {
  float bounds[6][4];  // as in BvhNode
  std::uint32_t begin[4], end[4];
};

struct Recoloring {
  Array<std::uint8_t> next;   // RecolorMarks of each material, for the next frame; empty: none ever changes
  Array<std::uint8_t> marks;  // the same of the frame that is followed
  bool any_next = false, any = false;
  bool has_holes = false;         // one stops other camera rays, too
  Array<RecoloredGroups> groups;  // of the triangles that stop other rays
  std::uint32_t group_count = 0;
  Box bounds = empty_box();
};

std::size_t recoloring_need(std::uint32_t material_count);
Recoloring make_recoloring(std::uint32_t material_count, Arena* keep);

// Between frames: a material has changed.
void mark_material(const Material& was, const Material& is, const Scene& scene, std::uint32_t index, Recoloring* r);

// A frame is followed: takes the marks that were made for it.
void take_marks(Recoloring* r);
// Follows a frame in which a material has changed. Returns why all of it must be traced, or null.
const char* follow_recoloring(const FrameData& frame, const MovingGeometry& moving, Recoloring* r);
// Adds the blocks whose rays passed a changed material's triangles.
void add_recolored(const FrameData& frame, const Recoloring& r, RayTables* tables);
// As find_changed_pixels(), of what the changed materials alter.
std::uint64_t find_recolored(const Recoloring& r, const ChangeSearch& search, std::uint32_t tile, std::uint64_t known,
                             std::uint64_t* given);
}  // namespace pocketray
