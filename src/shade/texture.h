// Texture look-ups. Texels are sRGB bytes; a look-up returns linear colour and alpha.
#pragma once
#include "effect/effect_probe.h"
#include "scene/scene.h"

namespace pocketray {

struct Rgba {
  Vec3 rgb;
  float alpha;
};

enum class TextureFilter : std::uint8_t;

// The colour of `use` at uv. Coordinates wrap as in the texture's sampler; row 0 is at v = 0.
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter);

// The same of a texture of numbers: texel bytes R, G, B as they are, 0 to 255.
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter);

// uv of a hit, interpolated from its triangle.
inline Vec2 hit_uv(const Scene& scene, std::uint32_t triangle, float u, float v) {
  const Triangle& t = scene.triangles[triangle];
  Vec2 a = scene.uvs[t.vertex(0)], b = scene.uvs[t.vertex(1)], c = scene.uvs[t.vertex(2)];
  float w = 1 - u - v;
  return {w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y};
}

// Alpha of a material at a hit: opacity × texture alpha × vertex alpha.
float material_alpha(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                     TextureFilter filter);

// The same, for the effect in question: alpha_mask or alpha_blend.
template <Effect effect>
float hit_alpha(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                TextureFilter filter) {
  static_assert(effect == Effect::alpha_mask || effect == Effect::alpha_blend, "no other effect reads alpha");
  effect_entered<effect>();
  return material_alpha(scene, material, triangle, u, v, filter);
}

}  // namespace pocketray
