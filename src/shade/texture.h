// Texture lookups. Texels are sRGB bytes; a lookup returns linear colour and alpha.
#pragma once
#include "effect/effect_probe.h"
#include "shade/frame_data.h"

namespace pocketray {

struct Rgba {
  Vec3 rgb;
  float alpha;
};

// Colour of `use` at uv. Coordinates wrap as the texture's sampler says; row 0 is at v = 0.
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter);
// Colour filtered for a footprint if the texture has levels (Effect::mip_map): between two levels, each bilinear; with
// the filter anisotropic, the mean of up to four lookups along the footprint's axis. The filters nearest and bilinear
// read level 0, as above.
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter,
                    const Footprint& footprint);

// Value of a texture of numbers: texel bytes R, G, B as they are, 0 to 255.
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter);
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter,
                    const Footprint& footprint);

// Calls whichever of the two the plan needs.
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

// Returns whether a texture reads the second set of coordinates (Effect::second_uv).
inline bool reads_second_uvs(const Scene& scene, const TextureUse& use) {
  return scene.textures[use.texture].uv_set > 0;
}
inline Vec2 texture_uv(const Scene& scene, const TextureUse& use, std::uint32_t triangle, float u, float v) {
  if (!reads_second_uvs(scene, use)) return hit_uv(scene, triangle, u, v);
  effect_entered<Effect::second_uv>();
  return hit_uv(scene, scene.second_uvs, triangle, u, v);
}

// Alpha of a material at a hit: opacity × texture alpha × vertex alpha. Selected for a plan's mask.
AlphaFunction find_alpha_function(EffectMask mask);

// Alpha for alpha_mask or alpha_blend. Holes and shadows have no footprint and read level 0: means would fill or widen
// holes with distance, and a surface and its shadow would differ.
template <Effect effect>
float hit_alpha(const FrameData& frame, const Material& material, std::uint32_t triangle, float u, float v,
                const Footprints& footprints = kNoFootprints) {
  static_assert(effect == Effect::alpha_mask || effect == Effect::alpha_blend, "no other effect reads alpha");
  effect_entered<effect>();
  return frame.kernels.alpha(*frame.scene, material, triangle, u, v, frame.settings.texture_filter, footprints);
}

// Sets the frame's color, numbers and alpha for its mask.
void find_texture_functions(FrameData* frame);

}  // namespace pocketray
