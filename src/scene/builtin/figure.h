// The figure that stands in for the paper's Venus: a standing woman with bare torso and broken arms, a robe wrapped
// around her hips, in the manner of late Hellenistic marbles. It is an implicit surface of smoothly blended ellipsoids
// and rounded cones [Quilez 2013, "smooth minimum"], bent into contrapposto and sampled by rays from its axis. One head
// is 1 unit; the figure stands on y = 0, looks along +z and is about 7.7 units high.
#pragma once
#include "scene/builtin/mesh_writer.h"

namespace pocketray {

struct FigureDetail {
  std::uint32_t columns, rows;          // of the body
  std::uint32_t arm_columns;            // of both arms
  std::uint32_t right_rows, left_rows;  // of the two arms
};

constexpr MeshSize figure_size(FigureDetail d) {
  return tube_size(d.columns, d.rows) + tube_size(d.arm_columns, d.right_rows) + tube_size(d.arm_columns, d.left_rows);
}
// Appends the figure, scaled, turned by `turn` radians about the vertical and standing on `base`: three closed tubes,
// the arms sunk into the shoulders.
void add_figure(MeshWriter* mesh, FigureDetail detail, const Vec3& base, float scale, float turn);

}  // namespace pocketray
