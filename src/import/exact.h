// Places in double, for models far from the origin: what is left after their offset is subtracted is rounded to float.
#pragma once
#include <vector>

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
// By the corners of a box.
void extend(ExactBox* box, const ExactTransform& to_world, const ExactBox& local);

// Whether rounding the coordinates of a model with these bounds and that many triangles would bend it.
bool is_far(const ExactBox& bounds, std::uint64_t triangle_count);
// The scene's origin in its own coordinates: zero, or the middle of the bounds where the model is far. Tells so.
Vec3d choose_origin(const ExactBox& bounds, std::uint64_t triangle_count, SceneBuilder* builder);
// The origin in coordinates of a model that `turn`, a permutation of axes, leads to the scene's.
Vec3d choose_origin(const ExactBox& bounds, const Transform& turn, std::uint64_t triangle_count, SceneBuilder* builder);
// Zero if none was chosen.
Vec3d origin_of(const SceneBuilder& builder);

// Chooses the origin for these positions, and where there is one, replaces `rounded` by what is left of them.
void recentre(const std::vector<Vec3d>& positions, const Transform& turn, std::uint64_t triangle_count,
              SceneBuilder* builder, std::vector<Vec3>* rounded);

}  // namespace pocketray
