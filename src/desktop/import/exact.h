// Positions in double, for models far from the origin; what remains after subtracting it is rounded to float.
#pragma once
#include "base/box.h"
#include "base/transform.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Transform in double.
struct ExactTransform {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};
ExactTransform exact(const Transform& t);
ExactTransform operator*(const ExactTransform& a, const ExactTransform& b);
Vec3d transform_point(const ExactTransform& t, const Vec3d& p);
// Subtracts the scene's origin and rounds.
Transform recentred(const ExactTransform& t, const Vec3d& origin);

struct ExactBox {
  Vec3d low = {1e300, 1e300, 1e300}, high = {-1e300, -1e300, -1e300};
};
void extend(ExactBox* box, const Vec3d& p);
// Returns whether a vertex at this position may be part of a triangle.
bool is_exact_coordinate(const Vec3d& p);

}  // namespace pocketray
