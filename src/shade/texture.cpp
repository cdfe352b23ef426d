#include "shade/texture.h"

#include <cmath>

#include "base/color.h"
#include "effect/settings.h"
#include "scene/texel_blocks.h"
#include "shade/footprint.h"

namespace pocketray {
namespace {

// In texels, clamped where a float no longer has a fraction: the difference of two infinities would be NaN.
float texel_coordinate(float u, int size) {
  float x = u * static_cast<float>(size);
  return x < 1e9f ? (x > -1e9f ? x : -1e9f) : 1e9f;
}

// The greatest integer not above x, |x| ≤ 1e9.
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

// The two ways to a texel.
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

// Of level 0.
template <class Texel, class Texels>
auto sample_base(const Scene& scene, const Texture& t, Vec2 place, TextureFilter filter) {
  const Level level = level_of<Texels>(scene, t, 0);
  const bool takes_nearest = filter == TextureFilter::as_scene ? t.nearest != 0 : filter == TextureFilter::nearest;
  return takes_nearest ? nearest<Texel, Texels>(level, place) : bilinear<Texel, Texels>(level, place);
}

// Between the levels next to lambda > 0. One level alone for the quarter of its octave on either side; in between, a
// mix, twice as steep.
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

template <class Texel>
auto sample(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter, float footprint) {
  const Texture& t = scene.textures[use.texture];
  const float turn = use.m[0][0] * use.m[1][1] - use.m[0][1] * use.m[1][0];
  const float texels = static_cast<float>(std::uint32_t(t.width) * t.height);
  const float lambda = texture_level(footprint * std::fabs(turn) * texels);
  if (t.level_count == 1 || !takes_levels(filter) || lambda == 0) return sample<Texel>(scene, use, uv, filter);
  const Vec2 place = transformed(use, uv);
  return t.format == TexelFormat::exact ? sample_levels<Texel, ExactTexels>(scene, t, place, lambda)
                                        : sample_levels<Texel, BlockTexels>(scene, t, place, lambda);
}

}  // namespace

Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  return sample<ColorTexel>(scene, use, uv, filter);
}
Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter, float footprint) {
  return sample<ColorTexel>(scene, use, uv, filter, footprint);
}

Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  return sample<NumberTexel>(scene, use, uv, filter);
}
Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter, float footprint) {
  return sample<NumberTexel>(scene, use, uv, filter, footprint);
}

float material_alpha(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                     TextureFilter filter, float footprint) {
  float alpha = material.opacity;
  if (material.diffuse_texture.texture != kNone && scene.uvs.count) {
    const Vec2 uv = hit_uv(scene, triangle, u, v);
    alpha *= (footprint > 0 ? sample_texture(scene, material.diffuse_texture, uv, filter, footprint)
                            : sample_texture(scene, material.diffuse_texture, uv, filter))
                 .alpha;
  }
  if (scene.colors.count) {
    const Triangle& t = scene.triangles[triangle];
    float a = scene.colors[t.vertex(0)].a, b = scene.colors[t.vertex(1)].a, c = scene.colors[t.vertex(2)].a;
    alpha *= ((1 - u - v) * a + u * b + v * c) * (1.0f / 65535.0f);
  }
  return alpha;
}

}  // namespace pocketray
