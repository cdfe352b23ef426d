// Where light comes from that a lobe seldom sends a ray to: that of area lights by way of mirrors and glass, where no
// point on a light can be connected, and that of point lights by way of a surface close to them, a small spot many
// times as bright as all else. So paths from the lights are followed beforehand, and each cell of the scene remembers
// the spots from which light reached it. Directions are then sampled towards those spots, too. They decide on the
// variance alone, as all ways to sample a direction are weighed by their common density [Veach 1997, sec. 9.2.4, the
// one-sample model].
#pragma once
#include "reference/optics.h"

namespace pocketray {

// Follows so many paths from the lights; the reference has all else that it needs.
void make_reference_guide(const FrameData& frame, std::uint32_t path_count, Arena* arena, Reference* reference);

// By way of what light reached a place.
struct ReferenceWay {
  Vec3d point;
  double margin;       // how far about the point it may come by, too
  std::uint32_t kind;  // spots of different kinds are never joined
};
constexpr std::uint32_t kByMirrors = 0;
// Room for cells, none of which has a spot; guide->cell_size is set.
std::size_t reference_cells_need();
void make_reference_cells(Arena* arena, ReferenceGuide* guide);
// In the eight cells about the point: so the edge of a lit region has spots as its middle has.
void remember(const Vec3d& point, const ReferenceWay& way, ReferenceGuide* guide);

// The cell that a point is in; null: none that has spots.
const ReferenceCell* find_cell(const ReferenceGuide& guide, const Vec3d& point);

// Density of sample_guided(), 1/sr; 0 where there are no lobes.
double guided_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);
// A direction by the lobes or towards a spot; arguments as those of sample_lobes(). The surface knows its cell.
bool sample_guided(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair,
                   Vec3d* direction);

// Bytes of arena that the guide takes.
std::size_t reference_guide_need(std::uint32_t triangle_count);

}  // namespace pocketray
