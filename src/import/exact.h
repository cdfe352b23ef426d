// Places in double, for models far from the origin: what is left after their offset is subtracted is rounded to float.
#pragma once
#include "base/box.h"
#include "base/transform.h"
#include "import/scene_builder.h"

namespace pocketray {

// As Transform, in double.
struct ExactTransform {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};
ExactTransform exact(const Transform& t);
ExactTransform operator*(const ExactTransform& a, const ExactTransform& b);
Vec3d transform_point(const ExactTransform& t, const Vec3d& p);
// Rounded, after the scene's origin is subtracted.
Transform recentred(const ExactTransform& t, const Vec3d& origin);

struct ExactBox {
  Vec3d low = {1e300, 1e300, 1e300}, high = {-1e300, -1e300, -1e300};
};
void extend(ExactBox* box, const Vec3d& p);
// Whether a vertex at the place may be part of a triangle.
bool is_exact_coordinate(const Vec3d& p);

}  // namespace pocketray
