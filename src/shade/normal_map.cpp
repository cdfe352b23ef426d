#include "shade/normal_map.h"

#include "effect/effect_probe.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

float component(float texel) {
  const float x = (texel - 128) / 127;
  return x > -1 ? x : -1;
}

}  // namespace

bool tangent_frame(const FrameData& frame, const Surface& s, const Vec3& n, Vec3* tangent, Vec3* bitangent) {
  const Scene& scene = *frame.scene;
  const Triangle& t = scene.triangles[s.hit.triangle];
  const std::uint32_t i = t.vertex(0), j = t.vertex(1), k = t.vertex(2);
  Vec3 along;
  bool at_vertices = false;
  int handedness = 0;
  if (scene.tangents.count) {
    const PackedTangent &p = scene.tangents[i], &q = scene.tangents[j], &r = scene.tangents[k];
    const Vec3 a = unpacked(p), b = unpacked(q), c = unpacked(r);
    at_vertices = !is_zero(a) && !is_zero(b) && !is_zero(c);
    if (at_vertices) {
      along = a * (1 - s.hit.u - s.hit.v) + b * s.hit.u + c * s.hit.v;
      handedness = p.handedness + q.handedness + r.handedness;
    }
  }
  if (handedness == 0) {
    if (scene.uvs.empty()) return false;
    const float eu = scene.uvs[j].x - scene.uvs[i].x, ev = scene.uvs[j].y - scene.uvs[i].y;
    const float fu = scene.uvs[k].x - scene.uvs[i].x, fv = scene.uvs[k].y - scene.uvs[i].y;
    const float area = eu * fv - ev * fu;  // twice the triangle's area in the texture, negative where v runs downwards
    if (!(area < 0 || area > 0)) return false;
    handedness = area < 0 ? 1 : -1;
    if (!at_vertices) {
      const Vec3 e = frame.geometry.positions[j] - frame.geometry.positions[i],
                 f = frame.geometry.positions[k] - frame.geometry.positions[i];
      along = (e * fv - f * ev) * (area < 0 ? -1.0f : 1.0f);
    }
  }
  *tangent = normalize(along - n * dot(n, along));
  *bitangent = cross(n, *tangent) * (handedness > 0 ? 1.0f : -1.0f);
  return !is_zero(*tangent);
}

Vec3 mapped_normal(const FrameData& frame, float scale, const Vec3& texel, const Ray& ray, const Surface& s) {
  effect_entered<Effect::normal_map>();
  const float x = component(texel.x) * scale, y = component(texel.y) * scale;
  if (x == 0 && y == 0) return s.normal;
  const Vec3 n = s.front ? s.normal : -s.normal;
  Vec3 tangent, bitangent;
  if (!tangent_frame(frame, s, n, &tangent, &bitangent)) return s.normal;
  Vec3 mapped = normalize(tangent * x + bitangent * y + n * component(texel.z));
  if (!s.front) mapped = -mapped;
  if (dot(mapped, ray.direction) > 0) {
    const Vec3 way = normalize(ray.direction);
    mapped = normalize(mapped - way * dot(mapped, way));
  }
  return is_zero(mapped) ? s.normal : mapped;
}

Vec2 turned_grain(const Vec2& direction, const Vec3& numbers) {
  const Vec2& d = direction;
  const float x = numbers.x * (2 / 255.0f) - 1, y = numbers.y * (2 / 255.0f) - 1, square = x * x + y * y;
  if (!(square > 0)) return {0, 0};
  const float scale = numbers.z * (1 / 255.0f) / std::sqrt(square);
  return {(d.x * x - d.y * y) * scale, (d.x * y + d.y * x) * scale};
}

Vec3 surface_grain(const FrameData& frame, const Grain& grain, const Surface& s) {
  effect_entered<Effect::anisotropy>();
  Vec2 d = grain.direction;
  Vec3 tangent, bitangent;
  if ((d.x == 0 && d.y == 0) || !tangent_frame(frame, s, s.front ? s.normal : -s.normal, &tangent, &bitangent))
    return {0, 0, 0};
  if (grain.texture.texture != kNone) d = turned_grain(d, frame.kernels.numbers(frame, grain.texture, s));
  return tangent * d.x + bitangent * d.y;
}

}  // namespace pocketray
