// How much of a texture a pixel covers: ray cones [Akenine-Möller et al. 2021, secs. 2 and 3]. A pixel's cone is as
// wide as the pixel and keeps its angle through mirrors and refraction: the curvature of surfaces, which would widen or
// narrow it, is left out, and so is the smaller angle of pixels away from the picture's centre. The texture's level is
// that of the covered area, the mean of both axes: [Akenine-Möller et al. 2021] takes the longer one, which blurs
// surfaces seen at a grazing angle. TextureFilter::anisotropic divides the area along the longer axis.
#pragma once
#include <cmath>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/frame_data.h"

namespace pocketray {

// Cone of a camera's pixel, divided among its samples.
inline PixelCone pixel_cone(const CameraRays& camera, std::uint32_t sample_count) {
  CHECK(sample_count >= 1 && sample_count <= kSampleCountMax);
  CHECK(camera.height >= 1);
  const float side = 2 * length(camera.up) / (camera.height * std::sqrt(static_cast<float>(sample_count)));
  return camera.orthographic ? PixelCone{side, 0} : PixelCone{side * camera.near_distance, side};
}

// Area that the cone covers in texture coordinates, where a ray of unit direction meets the triangle at the distance t
// from the eye: the cone's cross-section divided by the cosine, times the ratio of the triangle's area in the texture
// to that in the scene. `perpendicular` is the cross product of the triangle's edges, `normal` its unit vector. The
// largest float where the triangle is seen edge-on. Always finite, without invalid operations, for any scene.
inline float footprint(const PixelCone& cone, float t, const Vec3& direction, const Vec3& perpendicular,
                       const Vec3& normal, Array<const Vec2> uvs, const Triangle& triangle) {
  effect_entered<Effect::mip_map>();
  if (uvs.empty()) return 0;
  const Vec2 a = uvs[triangle.vertex(0)], b = uvs[triangle.vertex(1)], c = uvs[triangle.vertex(2)];
  const float area = std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  const float width = cone.width + t * cone.spread,
              seen = std::fabs(dot(normal, direction) * dot(normal, perpendicular));
  constexpr float kMost = std::numeric_limits<float>::max();
  if (!(area > 0 && width > 0)) return 0;
  const float covered = seen > 0 && width < kMost ? width / seen * width * area : kMost;
  return covered < kMost ? covered : kMost;
}

// Longer axis of the ellipse that the cone covers on the surface, end to end, in texture coordinates. It follows the
// ray [Akenine-Möller et al. 2021, sec. 5]; the other axis follows from the area. Where a texture is stretched, the
// other axis may be longer there; then a single lookup is made. Arguments as in footprint(). Zero where the ray is
// perpendicular to the surface or sees it edge-on. Always finite, without invalid operations.
inline Vec2 footprint_axis(const FrameData& frame, float t, const Vec3& direction, const Vec3& perpendicular,
                           const Vec3& normal, Array<const Vec2> uvs, const Triangle& triangle) {
  constexpr float kMost = 1e18f;                                                   // products of two are finite
  const float cosine = dot(normal, direction), size = dot(normal, perpendicular);  // twice the triangle's area
  if (uvs.empty() || !(std::fabs(cosine) > 0 && size > 0)) return {0, 0};
  const float stretch = (frame.view.cone.width + t * frame.view.cone.spread) / std::fabs(cosine);
  const Vec3 along = normalize(direction - normal * cosine), a = frame.geometry.positions[triangle.vertex(0)];
  const Vec3 e = frame.geometry.positions[triangle.vertex(1)] - a, f = frame.geometry.positions[triangle.vertex(2)] - a;
  const float du = dot(cross(along, f), normal) / size, dv = dot(cross(e, along), normal) / size;
  if (!(stretch < kMost && std::fabs(du) < kMost && std::fabs(dv) < kMost)) return {0, 0};
  const Vec2 p = uvs[triangle.vertex(0)], q = uvs[triangle.vertex(1)], r = uvs[triangle.vertex(2)];
  const Vec2 axis = {((q.x - p.x) * du + (r.x - p.x) * dv) * stretch, ((q.y - p.y) * du + (r.y - p.y) * dv) * stretch};
  return std::fabs(axis.x) < kMost && std::fabs(axis.y) < kMost ? axis : Vec2{0, 0};
}

// Mip level at which `texel_count` texels of level 0 become one: ½·log₂. Exact for powers of two, within 0.0005
// elsewhere; depends only on the float's bits. 0 for one texel or less and for NaN.
inline float texture_level(float texel_count) {
  if (!(texel_count > 1)) return 0;
  std::uint32_t word;
  std::memcpy(&word, &texel_count, sizeof word);
  const float exponent = static_cast<float>(static_cast<int>(word >> 23) - 127);
  const float x = static_cast<float>(word & 0x7FFFFFu) * 0x1p-23f;
  // log₂(1 + x), 0 ≤ x < 1: the chord and a cubic between its ends.
  return 0.5f * (exponent + (x + x * (1 - x) * (0.4228f - 0.159f * x)));
}

}  // namespace pocketray
