#include "shade/normal_map.h"

#include "effect/effect_probe.h"

namespace pocketray {
namespace {

float component(float texel) {
  const float x = (texel - 128) / 127;
  return x > -1 ? x : -1;
}

}  // namespace

Vec3 mapped_normal(const FrameData& frame, const MaterialMaps& maps, const Vec3& texel, const Ray& ray,
                   const Surface& s) {
  effect_entered<Effect::normal_map>();
  const Scene& scene = *frame.scene;
  const float x = component(texel.x) * maps.normal_scale, y = component(texel.y) * maps.normal_scale;
  if (x == 0 && y == 0) return s.normal;
  const Triangle& t = scene.triangles[s.hit.triangle];
  const std::uint32_t i = t.vertex(0), j = t.vertex(1), k = t.vertex(2);
  const Vec3 e = frame.positions[j] - frame.positions[i], f = frame.positions[k] - frame.positions[i];
  const float eu = scene.uvs[j].x - scene.uvs[i].x, ev = scene.uvs[j].y - scene.uvs[i].y;
  const float fu = scene.uvs[k].x - scene.uvs[i].x, fv = scene.uvs[k].y - scene.uvs[i].y;
  const float area = eu * fv - ev * fu;  // twice the triangle's in the texture, negative where that is mirrored
  if (!(area < 0 || area > 0)) return s.normal;
  const Vec3 n = s.front ? s.normal : -s.normal, along = (e * fv - f * ev) * (area < 0 ? -1.0f : 1.0f);
  const Vec3 tangent = normalize(along - n * dot(n, along));
  if (is_zero(tangent)) return s.normal;
  const Vec3 bitangent = cross(n, tangent) * (area < 0 ? 1.0f : -1.0f);
  Vec3 mapped = normalize(tangent * x + bitangent * y + n * component(texel.z));
  if (!s.front) mapped = -mapped;
  if (dot(mapped, ray.direction) > 0) {
    const Vec3 way = normalize(ray.direction);
    mapped = normalize(mapped - way * dot(mapped, way));
  }
  return is_zero(mapped) ? s.normal : mapped;
}

}  // namespace pocketray
