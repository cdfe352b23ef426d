#include "shade/texture.h"

#include <cmath>

#include "base/color.h"
#include "effect/settings.h"

namespace pocketray {
namespace {

// In texels, clamped where a float no longer has a fraction: the difference of two infinities would be NaN.
float texel_coordinate(float u, int size) {
  float x = u * static_cast<float>(size);
  return x < 1e9f ? (x > -1e9f ? x : -1e9f) : 1e9f;
}

// Index of a texel coordinate after wrapping. The coordinate is any integral float; sizes are at most 2^14.
int wrap_texel(float coordinate, int size, Wrap wrap) {
  float n = static_cast<float>(size);
  if (wrap == Wrap::clamp) return coordinate >= n ? size - 1 : coordinate > 0 ? static_cast<int>(coordinate) : 0;
  if (!(coordinate > -1e9f && coordinate < 1e9f)) return 0;
  float period = wrap == Wrap::mirror ? 2 * n : n;
  int i = static_cast<int>(coordinate - std::floor(coordinate / period) * period);
  int last = static_cast<int>(period) - 1;
  i = i < 0 ? 0 : i > last ? last : i;  // the floor of a rounded quotient may be off by one period
  return i < size ? i : 2 * size - 1 - i;
}

const std::uint8_t* texel_bytes(const Scene& scene, const Texture& t, int x, int y) {
  const std::uint32_t* texels = scene.texels.data + t.texel_begin;
  return reinterpret_cast<const std::uint8_t*>(texels + static_cast<std::size_t>(y) * t.width + x);
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

template <class Texel>
auto sample(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  const Texture& t = scene.textures[use.texture];
  auto at = [&](int x, int y) { return Texel::read(texel_bytes(scene, t, x, y)); };
  float u = use.m[0][0] * uv.x + use.m[0][1] * uv.y + use.m[0][2];
  float v = use.m[1][0] * uv.x + use.m[1][1] * uv.y + use.m[1][2];
  float x = texel_coordinate(u, t.width), y = texel_coordinate(v, t.height);
  bool nearest = filter == TextureFilter::as_scene ? t.nearest != 0 : filter == TextureFilter::nearest;
  if (nearest) return at(wrap_texel(std::floor(x), t.width, t.wrap_u), wrap_texel(std::floor(y), t.height, t.wrap_v));
  float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  float fx = (x - 0.5f) - left, fy = (y - 0.5f) - top;
  int x0 = wrap_texel(left, t.width, t.wrap_u), x1 = wrap_texel(left + 1, t.width, t.wrap_u);
  int y0 = wrap_texel(top, t.height, t.wrap_v), y1 = wrap_texel(top + 1, t.height, t.wrap_v);
  return blend(blend(at(x0, y0), at(x1, y0), fx), blend(at(x0, y1), at(x1, y1), fx), fy);
}

}  // namespace

Rgba sample_texture(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  return sample<ColorTexel>(scene, use, uv, filter);
}

Vec3 sample_numbers(const Scene& scene, const TextureUse& use, Vec2 uv, TextureFilter filter) {
  return sample<NumberTexel>(scene, use, uv, filter);
}

float material_alpha(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                     TextureFilter filter) {
  float alpha = material.opacity;
  if (material.diffuse_texture.texture != kNone && scene.uvs.count)
    alpha *= sample_texture(scene, material.diffuse_texture, hit_uv(scene, triangle, u, v), filter).alpha;
  if (scene.colors.count) {
    const Triangle& t = scene.triangles[triangle];
    float a = scene.colors[t.vertex(0)].a, b = scene.colors[t.vertex(1)].a, c = scene.colors[t.vertex(2)].a;
    alpha *= ((1 - u - v) * a + u * b + v * c) * (1.0f / 65535.0f);
  }
  return alpha;
}

}  // namespace pocketray
