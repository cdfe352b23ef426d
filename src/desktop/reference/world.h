// The triangles of a frame for the reference: a bounding volume hierarchy that shares nothing with the renderer's
// accelerators, so that neither inherits the other's errors. Boxes are floats, like the vertices, and never decide a
// hit; hits are computed in double precision.
#pragma once
#include "base/arena.h"
#include "shade/frame_data.h"

namespace pocketray {

// Four children side by side, for one box test.
struct alignas(16) ReferenceNode {
  float bounds[2][3][4];   // low and high, by axis, of each child; an empty box for missing ones
  std::uint32_t child[4];  // a node; a leaf if kReferenceLeafBit is set; kNone
};
// Up to four triangles side by side; the vertices of missing ones are NaN.
struct alignas(16) ReferenceLeaf {
  float corner[3][3][4];  // by vertex and axis
  std::uint32_t triangle[4];
};
constexpr std::uint32_t kReferenceLeafBit = 1u << 31;
constexpr std::uint32_t kReferenceDepthMax = 60;  // of the tree: 24 levels by the heuristic, then halving

struct ReferenceWorld {
  const FrameData* frame = nullptr;
  Array<ReferenceNode> nodes;  // the first is the root
  Array<ReferenceLeaf> leaves;
  float magnitude[3];  // upper bound of the coordinates along each axis
};

struct ReferenceRay {
  Vec3d origin, direction;
  double t_min, t_max;  // open interval
};

// Hits are ordered by t, then by triangle. After the last one, kNone with infinite t is returned.
struct ReferenceHit {
  double t, u, v;  // u, v: weights of the triangle's vertices 1 and 2
  std::uint32_t triangle;
};

// Bytes that the hierarchy takes from the arena.
std::size_t reference_world_need(std::uint32_t triangle_count);
// Builds it over the frame's posed triangles; the frame must outlive it.
ReferenceWorld make_reference_world(const FrameData& frame, Arena* arena);

// Returns the first hit after `after` in the order of hits (null: the very first), not counting cutouts.
ReferenceHit next_hit(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit* after);

// Which triangles cast no shadow, and whether transparent surfaces cast a full one.
struct ShadowRules {
  std::uint32_t but_triangle;    // casts no shadow; kNone: none
  const LightPoint* but_beside;  // nor do triangles in the flat piece of this lamp's point; null: none
  bool transparent_blocks;       // glass blocks light; blending surfaces do not
};
enum class Obstacle { none, clear, opaque };
// Returns the strongest obstacle on a ray: something opaque; else something that may transmit light; else none.
Obstacle find_obstacle(const ReferenceWorld& world, const ReferenceRay& ray, const ShadowRules& rules);

inline std::uint32_t material_index(const FrameData& frame, std::uint32_t triangle) {
  return frame.scene->triangles[triangle].material();
}
inline const Material& material_of(const FrameData& frame, std::uint32_t triangle) {
  return frame.scene->materials[material_index(frame, triangle)];
}
inline Vec3d corner_of(const FrameData& frame, std::uint32_t triangle, std::uint32_t i) {
  return to_double(frame.geometry.positions[frame.scene->triangles[triangle].vertex(i)]);
}
// Alpha of the material at a hit, from full-size texels.
double alpha_at(const FrameData& frame, std::uint32_t triangle, double u, double v);
// Returns whether a triangle is in the lamp's flat piece that contains a point of it, as in the renderer.
bool is_of_piece(const FrameData& frame, std::uint32_t triangle, const LightPoint& point);
inline bool casts_shadow(const FrameData& frame, std::uint32_t triangle, const ShadowRules& rules) {
  return triangle != rules.but_triangle && !(rules.but_beside && is_of_piece(frame, triangle, *rules.but_beside));
}
inline bool blocks(const Material& m, const ShadowRules& rules) {
  return is_zero(m.transmission) ? m.alpha_mode != AlphaMode::blend : rules.transparent_blocks;
}

}  // namespace pocketray
