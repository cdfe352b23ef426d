// Materials that were recoloured or retextured since the last frame, and the pixels that this changes: those whose
// first hits show them, and those whose shadow rays, or camera rays through holes, they block differently. Rays behind
// mirrors, and all that passed transparent surfaces, are in the tables.
#pragma once
#include "temporal/tile_changes.h"

namespace pocketray {

// Changed aspects of a material.
enum RecolorMark : std::uint8_t {
  kShownMark = 1,    // any
  kGivenMark = 2,    // diffuse reflection: pixels then pass different light to their neighbours
  kStoppedMark = 4,  // which rays it blocks
  kInsideMark = 8,   // absorption inside it
};

constexpr std::uint32_t kRecoloredGroups = 64;

// Four groups of triangles, consecutive in the scene.
struct RecoloredGroups {
  float bounds[6][4];  // as in BvhNode
  std::uint32_t begin[4], end[4];
};

struct Recoloring {
  Array<std::uint8_t> next;   // RecolorMarks of each material, for the next frame; empty: none ever changes
  Array<std::uint8_t> marks;  // RecolorMarks for the current frame
  bool any_next = false, any = false;
  bool has_holes = false;         // a material blocks other camera rays, too
  Array<RecoloredGroups> groups;  // of the triangles with changed blocking
  std::uint32_t group_count = 0;
  Box bounds = empty_box();
};

std::size_t recoloring_need(std::uint32_t material_count);
Recoloring make_recoloring(std::uint32_t material_count, Arena* keep);

// Call between frames after a change of a material.
void mark_material(const Material& was, const Material& is, const Scene& scene, std::uint32_t index, Recoloring* r);

// Call when a frame is followed: takes the marks made for it.
void take_marks(Recoloring* r);
// Follows a frame in which a material has changed. Returns the reason why all of it must be traced, or null.
const char* follow_recoloring(const FrameData& frame, const MovingGeometry& moving, Recoloring* r);
// Adds the blocks whose rays passed a changed material's triangles.
void add_recolored(const FrameData& frame, const Recoloring& r, RayTables* tables);
// find_changed_pixels() for the changes of materials.
std::uint64_t find_recolored(const Recoloring& r, const ChangeSearch& search, std::uint32_t tile, std::uint64_t known,
                             std::uint64_t* given);
}  // namespace pocketray
