// Chooses the scene's origin for a model far from its own, so that rounding to float keeps its shape.
#pragma once
#include <vector>

#include "desktop/import/exact.h"

namespace pocketray {

// Extent of a model in the scene's axes, before rounding: the bounds of all of it, and some of its positions, each
// weighted by the number of triangles that it represents.
struct ExactExtent {
  struct Sample {
    Vec3d place;
    double weight;
  };
  ExactBox bounds;
  std::vector<Sample> samples;
  double triangle_count = 0;
};
// Adds `count` points: at(i), placed by `to_world`. Skips points that no face can use.
template <class At>
void add_points(ExactExtent* extent, std::size_t count, At at, const ExactTransform& to_world, double triangle_count) {
  if (count == 0) return;
  constexpr std::size_t kSampleCount = 64;  // chosen: a twentieth of them is more than a stray one
  const std::size_t stride = count / kSampleCount + 1;
  const double weight = triangle_count / static_cast<double>((count + stride - 1) / stride);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d place = transform_point(to_world, at(i));
    if (!is_exact_coordinate(place)) continue;
    extend(&extent->bounds, place);
    if (i % stride == 0) extent->samples.push_back({place, weight});
  }
  extent->triangle_count += triangle_count;
}

// Returns whether rounding would distort a model with these bounds and this number of triangles.
bool is_far(const ExactBox& bounds, double triangle_count);

// Returns the scene's origin in its own coordinates: zero, or the middle of the bounds if the model is far; if most of
// it is far and a few parts are not, the middle of most, if the median position then loses less. Adds a note.
Vec3d choose_origin(const ExactExtent& extent, SceneBuilder* builder);
// Zero if none was chosen.
Vec3d origin_of(const SceneBuilder& builder);

// Returns the vector that `turn`, a permutation of axes, maps to `v`.
Vec3d turned_back(const Transform& turn, const Vec3d& v);
// Chooses the origin for these positions and, if there is one, replaces `rounded` by the remainders.
void recentre(const std::vector<Vec3d>& positions, const Transform& turn, double triangle_count, SceneBuilder* builder,
              std::vector<Vec3>* rounded);

}  // namespace pocketray
