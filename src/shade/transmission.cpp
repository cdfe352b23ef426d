#include "shade/transmission.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/media.h"

namespace pocketray {
namespace {

Vec3 transmission_at(const FrameData& frame, const GlassMap& glass, const MetallicRoughness& model, const Surface& s) {
  const float passes = s.transmission * (1 - static_cast<float>(s.metallic) / 65535);
  Vec3 tint = model.base * passes;
  if (s.is_tinted) tint *= s.tint;
  if (!s.material->thin || !(glass.thickness > 0)) return tint;
  float thickness = glass.thickness;
  if (glass.thickness_texture.texture != kNone)
    thickness *= frame.kernels.numbers(frame, glass.thickness_texture, s).y / 255;
  return tint * transmittance(s.material->absorption, thickness);
}

}  // namespace

void find_transmission(const FrameData& frame, const GlassMap& glass, Surface* s) {
  CHECK(s != nullptr && s->material != nullptr);
  effect_entered<Effect::transmission_map>();
  s->transmission = glass.transmission;
  if (glass.transmission_texture.texture != kNone)
    s->transmission *= frame.kernels.numbers(frame, glass.transmission_texture, *s).x / 255;
  s->diffuse = s->diffuse * (1 - s->transmission);
}

Vec3 transmission_of(const FrameData& frame, const Ray& ray, const Face& face, const Surface& s) {
  const Scene& scene = *frame.scene;
  const GlassMap* glass = glass_map_of(scene, face.material);
  if (!glass || !has(frame.mask, Effect::transmission_map)) return scene.materials[face.material].transmission;
  const MetallicRoughness& model = scene.material_maps[face.material].model;
  if (face.hit.triangle == s.hit.triangle) return transmission_at(frame, *glass, model, s);
  Surface other;
  Hit place = face.hit;
  place.t = 0;  // its distance is not along the path: reads the textures' largest level
  frame.kernels.surface(frame, ray, place, &other);
  return transmission_at(frame, *glass, model, other);
}

}  // namespace pocketray
