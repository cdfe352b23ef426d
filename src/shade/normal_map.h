// Normals from a texture (Effect::normal_map, glTF sec. 3.9.3).
#pragma once
#include "shade/surface.h"

namespace pocketray {

// Tangent frame of maps at the surface, for a unit normal n of its front. The tangent is interpolated from the
// vertices, else the triangle's ∂P/∂u, and made perpendicular to n; the bitangent is perpendicular to both, on the side
// of the vertices' handedness (of the majority if they differ), else against ∂P/∂v. Vertices that move have no
// tangents, and triangles at the seam of a mirrored texture may have none: there, the frame turns about n from triangle
// to triangle. Returns false if a direction vanishes or, without handedness, if texture coordinates span no area.
bool tangent_frame(const FrameData& frame, const Surface& s, const Vec3& n, Vec3* tangent, Vec3* bitangent);

// Unit normal of the surface by its map, given the map's scale and numbers (texel), in the shading normal's tangent
// frame.
// MikkTSpace leaves the tangent as it is interpolated; ours is unit and perpendicular.
//   - A texel (128, 128, z) gives n itself, bit for bit.
//   - On the back of a surface, the normal is that of the front reversed.
//   - A normal that faces away from the viewer is bent back to the viewer's horizon: the part of it that is
// perpendicular to the ray. Such a point is seen edge-on; it is lit, and mirrors by the geometric normal.
//   - Where there is no frame, the normal is n.
Vec3 mapped_normal(const FrameData& frame, float scale, const Vec3& texel, const Ray& ray, const Surface& s);

// Direction of a grain, turned and weakened by its texture's numbers.
Vec2 turned_grain(const Vec2& direction, const Vec3& numbers);
// LobeFrame::grain of a surface whose normal is final (Effect::anisotropy).
Vec3 surface_grain(const FrameData& frame, const Grain& grain, const Surface& s);

}  // namespace pocketray
