#include "shade/texture.h"

#include <cmath>

#include "base/color.h"
#include "effect/settings.h"
#include "scene/texel_blocks.h"
#include "shade/footprint.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

// Texel coordinate, clamped where a float no longer has a fraction: the difference of two infinities would be NaN.
float texel_coordinate(float u, int size) {
  float x = u * static_cast<float>(size);
  return x < 1e9f ? (x > -1e9f ? x : -1e9f) : 1e9f;
}

// Floor of x, |x| ≤ 1e9.
int floor_of(float x) {
  const int i = static_cast<int>(x);
  return static_cast<float>(i) > x ? i - 1 : i;
}

// Index of a texel after wrapping; |i| ≤ 1e9 + 1.
int wrap_texel(int i, int size, Wrap wrap) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
  if (wrap == Wrap::clamp) return i < 0 ? 0 : size - 1;
  const int period = wrap == Wrap::mirror ? 2 * size : size, rest = i % period;
  const int place = rest < 0 ? rest + period : rest;
  return place < size ? place : 2 * size - 1 - place;
}

// A level of a texture.
struct Level {
  const std::uint32_t* words;
  int width, height;
  Wrap wrap_u, wrap_v;
  TexelFormat format;
};

// The two formats of texels.
struct ExactTexels {
  static std::uint32_t words(const Texture& t, std::uint32_t level_count) {
    return level_texels(t.width, t.height, level_count);
  }
  static int words(const Level& level) { return level.width * level.height; }
  template <class Texel>
  static auto read(const Level& level, int x, int y) {
    const std::uint32_t* texel = level.words + static_cast<std::size_t>(y) * level.width + x;
    return Texel::read(reinterpret_cast<const std::uint8_t*>(texel));
  }
};
struct BlockTexels {
  static std::uint32_t words(const Texture& t, std::uint32_t level_count) {
    return level_words(t.format, t.width, t.height, level_count);
  }
  static std::uint32_t words(const Level& level) {
    return level_words(level.format, static_cast<std::uint32_t>(level.width), static_cast<std::uint32_t>(level.height),
                       1);
  }
  template <class Texel>
  static auto read(const Level& level, int x, int y) {
    const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
    const std::size_t across = block_count(level.format, static_cast<std::uint32_t>(level.width));
    const std::size_t block = row / kBlockSide * across + column / kBlockSide;
    const std::uint32_t texel = block_texel(level.format, level.words + block * block_words(level.format),
                                            row % kBlockSide * kBlockSide + column % kBlockSide);
    return Texel::read(reinterpret_cast<const std::uint8_t*>(&texel));
  }
};

template <class Texels>
Level level_of(const Scene& scene, const Texture& t, std::uint32_t level) {
  return {scene.texels.data + t.texel_begin + Texels::words(t, level),
          static_cast<int>(level_side(t.width, level)),
          static_cast<int>(level_side(t.height, level)),
          t.wrap_u,
          t.wrap_v,
          t.format};
}

template <class Texels>
Level next_level(const Level& level) {
  return {level.words + Texels::words(level),
          level.width > 1 ? level.width / 2 : 1,
          level.height > 1 ? level.height / 2 : 1,
          level.wrap_u,
          level.wrap_v,
          level.format};
}

struct ColorTexel {
  static Rgba read(const std::uint8_t* c) {
    return {{srgb_to_linear(c[0]), srgb_to_linear(c[1]), srgb_to_linear(c[2])},
            static_cast<float>(c[3]) * (1.0f / 255.0f)};
  }
};

struct NumberTexel {
  static Vec3 read(const std::uint8_t* c) {
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }
};

// Coordinates from the set that the texture reads, if any texture may read the second one.
template <bool both_sets>
Vec2 uv_at(const Scene& scene, const TextureUse& use, const Surface& s) {
  if constexpr (both_sets) return texture_uv(scene, use, s.hit.triangle, s.hit.u, s.hit.v);
  return hit_uv(scene, s.hit.triangle, s.hit.u, s.hit.v);
}
template <bool both_sets>
const Footprint& footprint_at(const Scene& scene, const TextureUse& use, const Footprints& footprints) {
  return both_sets && reads_second_uvs(scene, use) ? footprints.second : footprints;
}

Vec3 blend(const Vec3& a, const Vec3& b, float f) { return a + (b - a) * f; }
Rgba blend(const Rgba& a, const Rgba& b, float f) {
  return {blend(a.rgb, b.rgb, f), a.alpha + (b.alpha - a.alpha) * f};
}

Vec2 transformed(const TextureUse& use, Vec2 uv) {
  return {use.m[0][0] * uv.x + use.m[0][1] * uv.y + use.m[0][2], use.m[1][0] * uv.x + use.m[1][1] * uv.y + use.m[1][2]};
}

template <class Texel, class Texels>
auto nearest(const Level& level, Vec2 uv) {
  const float x = texel_coordinate(uv.x, level.width), y = texel_coordinate(uv.y, level.height);
  return Texels::template read<Texel>(level, wrap_texel(floor_of(x), level.width, level.wrap_u),
                                      wrap_texel(floor_of(y), level.height, level.wrap_v));
}

template <class Texel, class Texels>
auto bilinear(const Level& level, Vec2 uv) {
  auto at = [&](int x, int y) { return Texels::template read<Texel>(level, x, y); };
  const float x = texel_coordinate(uv.x, level.width), y = texel_coordinate(uv.y, level.height);
  const int left = floor_of(x - 0.5f), top = floor_of(y - 0.5f);
  const float fx = (x - 0.5f) - static_cast<float>(left), fy = (y - 0.5f) - static_cast<float>(top);
  const int x0 = wrap_texel(left, level.width, level.wrap_u), x1 = wrap_texel(left + 1, level.width, level.wrap_u);
  const int y0 = wrap_texel(top, level.height, level.wrap_v), y1 = wrap_texel(top + 1, level.height, level.wrap_v);
  return blend(blend(at(x0, y0), at(x1, y0), fx), blend(at(x0, y1), at(x1, y1), fx), fy);
}

// Samples level 0.
template <class Texel, class Texels>
auto sample_base(const Scene& scene, const Texture& t, Vec2 place, TextureFilter filter) {
  const Level level = level_of<Texels>(scene, t, 0);
  const bool takes_nearest = filter == TextureFilter::as_scene ? t.nearest != 0 : filter == TextureFilter::nearest;
  return takes_nearest ? nearest<Texel, Texels>(level, place) : bilinear<Texel, Texels>(level, place);
}

// Samples between the levels around lambda ≥ 0: a single level within a quarter of an octave of it, in between a mix,
// twice as steep.
template <class Texel, class Texels>
auto sample_levels(const Scene& scene, const Texture& t, Vec2 place, float lambda) {
  const std::uint32_t last = t.level_count - 1u;
  const auto finer = static_cast<std::uint32_t>(lambda);
  const float mix = 2 * (lambda - static_cast<float>(finer)) - 0.5f;
  if (finer >= last) return bilinear<Texel, Texels>(level_of<Texels>(scene, t, last), place);
  const Level level = level_of<Texels>(scene, t, finer);
  if (mix <= 0) return bilinear<Texel, Texels>(level, place);
  const auto coarse = bilinear<Texel, Texels>(next_level<Texels>(level), place);
  return mix >= 1 ? coarse : blend(bilinear<Texel, Texels>(level, place), coarse, mix);
}

template <class Texel>
auto sample(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  const Texture& t = scene.textures[use.texture];
  const Vec2 place = transformed(use, uv);
  return t.format == TexelFormat::exact ? sample_base<Texel, ExactTexels>(scene, t, place, filter)
                                        : sample_base<Texel, BlockTexels>(scene, t, place, filter);
}

Vec3 add(const Vec3& a, const Vec3& b) { return a + b; }
Rgba add(const Rgba& a, const Rgba& b) { return {a.rgb + b.rgb, a.alpha + b.alpha}; }
Vec3 scaled(const Vec3& a, float factor) { return a * factor; }
Rgba scaled(const Rgba& a, float factor) { return {a.rgb * factor, a.alpha * factor}; }

template <class Texel>
auto sample_level(const Scene& scene, const Texture& t, Vec2 place, float lambda) {
  return t.format == TexelFormat::exact ? sample_levels<Texel, ExactTexels>(scene, t, place, lambda)
                                        : sample_levels<Texel, BlockTexels>(scene, t, place, lambda);
}

// Number of lookups for a footprint of this area, in texels, and axis: the ratio of its length to its width, but no
// more than the texels along the axis.
int place_count(float area, float axis_square) {
  constexpr int kMost = 4;
  int count = 1;
  while (count < kMost && axis_square > area * static_cast<float>(count) &&
         axis_square > static_cast<float>(count * count))
    ++count;
  return count;
}

// Mean of lookups along the axis of the footprint, each for an equal part of the area.
template <class Texel>
auto sample_along_axis(const Scene& scene, const TextureUse& use, Vec2 uv, float area, const Vec2& axis) {
  const Texture& t = scene.textures[use.texture];
  const Vec2 place = transformed(use, uv);
  const Vec2 way = {use.m[0][0] * axis.x + use.m[0][1] * axis.y, use.m[1][0] * axis.x + use.m[1][1] * axis.y};
  const float across = way.x * static_cast<float>(t.width), down = way.y * static_cast<float>(t.height);
  const int count = place_count(area, across * across + down * down);
  const float share = 1 / static_cast<float>(count), lambda = texture_level(area * share);
  auto at = [&](int i) {
    const float step = (static_cast<float>(i) + 0.5f) * share - 0.5f;
    return sample_level<Texel>(scene, t, {place.x + way.x * step, place.y + way.y * step}, lambda);
  };
  auto sum = at(0);
  for (int i = 1; i < count; ++i) sum = add(sum, at(i));
  return scaled(sum, share);
}

template <class Texel>
auto sample(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter, const Footprint& footprint) {
  const Texture& t = scene.textures[use.texture];
  const float turn = use.m[0][0] * use.m[1][1] - use.m[0][1] * use.m[1][0];
  const float texels = static_cast<float>(std::uint32_t(t.width) * t.height);
  const float area = footprint.area * std::fabs(turn) * texels, lambda = texture_level(area);
  if (t.level_count == 1 || !takes_levels(filter)) return sample<Texel>(scene, use, uv, filter);
  if (filter == TextureFilter::anisotropic) return sample_along_axis<Texel>(scene, use, uv, area, footprint.axis);
  if (lambda == 0) return sample<Texel>(scene, use, uv, filter);
  return sample_level<Texel>(scene, t, transformed(use, uv), lambda);
}

}  // namespace

Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  return sample<ColorTexel>(scene, use, uv, filter);
}
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter,
                    const Footprint& footprint) {
  return sample<ColorTexel>(scene, use, uv, filter, footprint);
}

Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  return sample<NumberTexel>(scene, use, uv, filter);
}
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter,
                    const Footprint& footprint) {
  return sample<NumberTexel>(scene, use, uv, filter, footprint);
}

namespace {

template <bool both_sets>
float material_alpha(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                     TextureFilter filter, const Footprints& footprints) {
  float alpha = material.opacity;
  if (material.diffuse_texture.texture != kNone && scene.uvs.count) {
    const TextureUse& use = material.diffuse_texture;
    const Vec2 uv = both_sets ? texture_uv(scene, use, triangle, u, v) : hit_uv(scene, triangle, u, v);
    const Footprint& footprint = footprint_at<both_sets>(scene, use, footprints);
    alpha *= (footprint.area > 0 ? sample_texture(scene, material.diffuse_texture, uv, filter, footprint)
                                 : sample_texture(scene, material.diffuse_texture, uv, filter))
                 .alpha;
  }
  if (scene.colors.count) {
    const Triangle& t = scene.triangles[triangle];
    float a = scene.colors[t.vertex(0)].a, b = scene.colors[t.vertex(1)].a, c = scene.colors[t.vertex(2)].a;
    alpha *= (a + u * (b - a) + v * (c - a)) * (1.0f / 65535.0f);  // exact where equal
  }
  return alpha;
}

template <bool has_levels, bool both_sets>
Rgba surface_color(const FrameData& frame, const TextureUse& use, const Surface& s) {
  const Scene& scene = *frame.scene;
  const Vec2 uv = uv_at<both_sets>(scene, use, s);
  const TextureFilter filter = frame.settings.texture_filter;
  if constexpr (has_levels)
    return sample_texture(scene, use, uv, filter, footprint_at<both_sets>(scene, use, s.footprint));
  return sample_texture(scene, use, uv, filter);
}

template <bool has_levels, bool both_sets>
Vec3 surface_numbers(const FrameData& frame, const TextureUse& use, const Surface& s) {
  const Scene& scene = *frame.scene;
  const Vec2 uv = uv_at<both_sets>(scene, use, s);
  const TextureFilter filter = frame.settings.texture_filter;
  if constexpr (has_levels)
    return sample_numbers(scene, use, uv, filter, footprint_at<both_sets>(scene, use, s.footprint));
  return sample_numbers(scene, use, uv, filter);
}

template <bool has_levels, bool both_sets>
void set_texture_functions(FrameData* frame) {
  frame->kernels.color = surface_color<has_levels, both_sets>,
  frame->kernels.numbers = surface_numbers<has_levels, both_sets>;
}

}  // namespace

AlphaFunction find_alpha_function(EffectMask mask) {
  if (has(mask, Effect::second_uv)) return material_alpha<has(kAllEffects, Effect::second_uv)>;
  return material_alpha<false>;
}

void find_texture_functions(FrameData* frame) {
  constexpr bool levels = has(kAllEffects, Effect::mip_map), both = has(kAllEffects, Effect::second_uv);
  CHECK(frame != nullptr);
  frame->kernels.alpha = find_alpha_function(frame->mask);
  CHECK(frame->kernels.alpha != nullptr);
  if (has(frame->mask, Effect::second_uv))
    has(frame->mask, Effect::mip_map) ? set_texture_functions<levels, both>(frame)
                                      : set_texture_functions<false, both>(frame);
  else
    has(frame->mask, Effect::mip_map) ? set_texture_functions<levels, false>(frame)
                                      : set_texture_functions<false, false>(frame);
}

}  // namespace pocketray
