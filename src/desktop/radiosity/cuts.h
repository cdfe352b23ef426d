// Cells of flat surfaces are cut along the outlines of what lies on them or close above them: a lamp below a ceiling, a
// box on a floor, a partition between walls. Light does not spread across such a line, so that no cell should
// [Heckbert 1992, "Discontinuity Meshing for Radiosity"].
#pragma once
#include "desktop/radiosity/surfaces.h"

namespace pocketray {

// Part of a cell that lies on one triangle.
struct Piece {
  Polygon polygon;
  std::uint32_t triangle;
};

// The part of a polygon where dot(p − origin, axis) ≥ limit.
Polygon clip(const Polygon& polygon, const Vec3d& origin, const Vec3d& axis, double limit);

struct CutEdge {
  Vec3d a, b;
  bool is_end;             // of an open surface
  std::uint32_t triangle;  // that it bounds
  double gap;              // its largest distance from a plane onto which it was projected
};

// Outlines of flat parts: edges at which surfaces end or bend, as far as they are as long as half a patch or bound
// something that emits.
std::vector<CutEdge> find_cut_edges(const Scene& scene, const Surfaces& surfaces);

// The parts of edges within a quarter of a patch of a flat surface's plane, projected onto it.
std::vector<CutEdge> edges_close_to(const FlatSurface& flat, const std::vector<CutEdge>& edges, double patch_side);

// Divides a cell along the edges that run through it.
std::vector<std::vector<Piece>> cut_cell(const FlatSurface& flat, const std::vector<CutEdge>& edges,
                                         const std::vector<Piece>& cell);

}  // namespace pocketray
