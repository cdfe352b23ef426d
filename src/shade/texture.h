// Texture look-ups. Texels are sRGB bytes; a look-up returns linear colour and alpha.
#pragma once
#include "effect/effect_probe.h"
#include "shade/frame_data.h"

namespace pocketray {

struct Rgba {
  Vec3 rgb;
  float alpha;
};

// The colour of `use` at uv. Coordinates wrap as in the texture's sampler; row 0 is at v = 0.
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter);
// The same, filtered for a footprint where the texture has levels (Effect::mip_map): between two levels, each bilinear;
// with the filter anisotropic, the mean of up to four places along the footprint's axis. With the filters nearest and
// bilinear, level 0 as above.
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter,
                    const Footprint& footprint);

// The same of a texture of numbers: texel bytes R, G, B as they are, 0 to 255.
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter);
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter,
                    const Footprint& footprint);

// The one of the two that the plan calls for.
template <bool has_levels>
Rgba color_at(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter, const Footprint& footprint) {
  if constexpr (has_levels) return sample_texture(scene, use, uv, filter, footprint);
  return sample_texture(scene, use, uv, filter);
}
template <bool has_levels>
Vec3 numbers_at(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter, const Footprint& footprint) {
  if constexpr (has_levels) return sample_numbers(scene, use, uv, filter, footprint);
  return sample_numbers(scene, use, uv, filter);
}

// uv of a hit, interpolated from its triangle.
inline Vec2 hit_uv(const Scene& scene, Array<const Vec2> uvs, std::uint32_t triangle, float u, float v) {
  const Triangle& t = scene.triangles[triangle];
  Vec2 a = uvs[t.vertex(0)], b = uvs[t.vertex(1)], c = uvs[t.vertex(2)];
  float w = 1 - u - v;
  return {w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y};
}
inline Vec2 hit_uv(const Scene& scene, std::uint32_t triangle, float u, float v) {
  return hit_uv(scene, scene.uvs, triangle, u, v);
}

// The same of the set that a texture reads (Effect::second_uv).
inline bool reads_second_uvs(const Scene& scene, const TextureUse& use) {
  return scene.textures[use.texture].uv_set > 0;
}
inline Vec2 texture_uv(const Scene& scene, const TextureUse& use, std::uint32_t triangle, float u, float v) {
  if (!reads_second_uvs(scene, use)) return hit_uv(scene, triangle, u, v);
  effect_entered<Effect::second_uv>();
  return hit_uv(scene, scene.second_uvs, triangle, u, v);
}

// Alpha of a material at a hit: opacity × texture alpha × vertex alpha. For a plan's mask.
AlphaFunction find_alpha_function(EffectMask mask);

// The same, for the effect in question: alpha_mask or alpha_blend. Without footprints, as for holes and shadows, of
// level 0: means would fill or widen holes with the distance, and a surface and its shadow would differ.
template <Effect effect>
float hit_alpha(const FrameData& frame, const Material& material, std::uint32_t triangle, float u, float v,
                const Footprints& footprints = kNoFootprints) {
  static_assert(effect == Effect::alpha_mask || effect == Effect::alpha_blend, "no other effect reads alpha");
  effect_entered<effect>();
  return frame.alpha(*frame.scene, material, triangle, u, v, frame.settings.texture_filter, footprints);
}

// Sets the frame's color, numbers and alpha for its mask.
void find_texture_functions(FrameData* frame);

}  // namespace pocketray
