// The guide finds light towards which lobes seldom send a ray: light of area lights by way of mirrors and glass, where
// no point on a light can be connected, and light of point lights by way of a surface close to them, a small spot many
// times as bright as its surroundings. Paths are traced from the lights in advance, and each cell of the scene
// remembers the spots from which light reached it. Directions are then also sampled towards those spots. This affects
// only the variance, since all ways to sample a direction are weighted by their common density [Veach 1997, sec. 9.2.4,
// the one-sample model].
#pragma once
#include "desktop/reference/optics.h"

namespace pocketray {

// Traces that many paths from the lights; the reference must be complete otherwise.
void make_reference_guide(const FrameData& frame, std::uint32_t path_count, Arena* arena, Reference* reference);

// The spot that light passed on its way to a place.
struct ReferenceWay {
  Vec3d point;
  double margin;       // tolerance around the point
  std::uint32_t kind;  // spots of different kinds are never merged
};
constexpr std::uint32_t kByMirrors = 0;
// Bytes of the table of cells, all without spots. guide->cell_size must be set.
std::size_t reference_cells_need();
void make_reference_cells(Arena* arena, ReferenceGuide* guide);
// Adds the spot to the eight cells around the point, so that the edge of a lit region has spots like its middle.
void remember(const Vec3d& point, const ReferenceWay& way, ReferenceGuide* guide);

// Returns the cell of a point; null if it has no spots.
const ReferenceCell* find_cell(const ReferenceGuide& guide, const Vec3d& point);

// Density of sample_guided(), 1/sr; 0 without lobes.
double guided_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);
// Samples a direction by the lobes or towards a spot; arguments as in sample_lobes(). The surface must have its cell.
bool sample_guided(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair,
                   Vec3d* direction);

// Bytes that the guide takes from the arena.
std::size_t reference_guide_need(std::uint32_t triangle_count);

}  // namespace pocketray
