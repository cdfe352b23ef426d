#include "scene/invisible.h"

#include <cmath>
#include <cstring>

#include "base/check.h"
#include "scene/channel.h"
#include "scene/texel_blocks.h"

namespace pocketray {
namespace {

// Bound of the rounding of alpha interpolated between texels or vertices, which lies in 0 … 1: each of at most eight
// operations errs by 2⁻²⁴ or less.
constexpr double kAlphaRounding = 0x1p-20;
constexpr float kRotationRounding = 0x1p-22f;  // of a unit quaternion, normalised again

struct Texel {
  std::uint8_t r, g, b, a;
};
Texel texel_of(std::uint32_t word) {
  Texel texel;
  std::memcpy(&texel, &word, sizeof texel);
  return texel;
}

// Returns whether all texels of all levels pass the test; stops at the first that does not.
template <class Test>
bool every_texel(const Scene& scene, const TextureUse& use, Test test) {
  CHECK_LT(use.texture, scene.textures.count);
  const Texture& t = scene.textures[use.texture];
  const std::uint32_t* words = scene.texels.data + t.texel_begin;
  if (t.format == TexelFormat::exact) {
    const std::uint32_t count = level_texels(t.width, t.height, t.level_count);
    for (std::uint32_t i = 0; i < count; ++i)
      if (!test(texel_of(words[i]))) return false;
    return true;
  }
  for (std::uint32_t level = 0; level < t.level_count; ++level) {
    const std::uint32_t width = level_side(t.width, level), height = level_side(t.height, level);
    const std::uint32_t across = block_count(t.format, width);
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        const std::size_t block = std::size_t(y / kBlockSide) * across + x / kBlockSide;
        const std::uint32_t place = y % kBlockSide * kBlockSide + x % kBlockSide;
        if (!test(texel_of(block_texel(t.format, words + block * block_words(t.format), place)))) return false;
      }
    words += std::size_t(across) * block_count(t.format, height) * block_words(t.format);
  }
  return true;
}

struct AlphaRange {
  std::uint32_t low, high;
};

AlphaRange vertex_alpha(const Scene& scene, std::uint32_t material) {
  if (scene.colors.empty()) return {65535, 65535};
  CHECK_EQ(scene.colors.count, scene.positions.count);
  AlphaRange range = {65535, 0};
  for (const Triangle& t : scene.triangles) {
    if (t.material() != material) continue;
    for (std::uint32_t v : t.vertices()) {
      const std::uint32_t a = scene.colors[v].a;
      if (a < range.low) range.low = a;
      if (a > range.high) range.high = a;
    }
  }
  return range;
}

// Returns whether alpha, as kernels compute it, is at least `wanted` everywhere.
bool reaches_alpha(const Scene& scene, std::uint32_t material, float wanted) {
  const Material& m = scene.materials[material];
  if (m.opacity < wanted) return false;
  const AlphaRange at_vertices = vertex_alpha(scene, material);
  AlphaRange at_texels = {255, 0};
  if (m.diffuse_texture.texture != kNone && scene.uvs.count) {
    if (!every_texel(scene, m.diffuse_texture, [&](const Texel& texel) {
          if (texel.a < at_texels.low) at_texels.low = texel.a;
          if (texel.a > at_texels.high) at_texels.high = texel.a;
          return m.opacity * (static_cast<float>(texel.a) * (1.0f / 255.0f)) >= wanted;
        }))
      return false;
  } else {
    at_texels.high = 255;
  }
  if (at_vertices.low >= at_vertices.high && at_texels.low == at_texels.high)
    return m.opacity * (static_cast<float>(at_texels.low) * (1.0f / 255.0f)) *
               (static_cast<float>(at_vertices.low) * (1.0f / 65535.0f)) >=
           wanted;
  return static_cast<double>(m.opacity) * (at_texels.low / 255.0 - kAlphaRounding) *
             (at_vertices.low / 65535.0 - kAlphaRounding) >=
         static_cast<double>(wanted);
}

// Returns whether a triangle is perpendicular to an axis that its normals lie along. Interpolated and normalised, such
// normals are exactly the axis, and so is the triangle's own.
bool is_flat_along_axis(const Scene& scene, const Triangle& t) {
  for (int axis = 0; axis < 3; ++axis) {
    bool is_flat = true;
    for (std::uint32_t v : t.vertices()) {
      const Vec3& n = scene.normals[v];
      is_flat &= scene.positions[v][axis] == scene.positions[t.vertex(0)][axis] && n[(axis + 1) % 3] == 0 &&
                 n[(axis + 2) % 3] == 0;
    }
    if (is_flat) return true;
  }
  return false;
}

bool keys_are_equal(const Scene& scene, const Channel& channel, std::uint32_t width) {
  CHECK_LT(channel.value_begin, scene.key_values.count);
  const float* first = scene.key_values.data + channel.value_begin;
  const bool is_cubic = channel.interpolation == Interpolation::cubic;
  const std::uint32_t stride = is_cubic ? 3 * width : width, middle = is_cubic ? width : 0;
  for (std::uint32_t k = 0; k < channel.key_count; ++k)
    for (std::uint32_t i = 0; i < width; ++i) {
      const float* key = first + std::size_t(k) * stride;
      if (key[middle + i] != first[middle + i]) return false;
      if (is_cubic && (key[i] != 0 || key[2 * width + i] != 0)) return false;
    }
  return true;
}

bool is_rotation(const Quaternion& a, const Quaternion& b) {
  return std::fabs(a.x - b.x) <= kRotationRounding && std::fabs(a.y - b.y) <= kRotationRounding &&
         std::fabs(a.z - b.z) <= kRotationRounding && std::fabs(a.w - b.w) <= kRotationRounding;
}

bool weights_are(const Scene& scene, const Channel& channel, const float* value) {
  const Node& node = scene.nodes[channel.node];
  for (std::uint32_t i = 0; i < node.weight_count; ++i)
    if (scene.weights[node.weight_begin + i] != value[i]) return false;
  return true;
}

// Returns whether the channel holds its target at the value that it has at rest.
bool holds_target(const Scene& scene, const Channel& channel) {
  const std::uint32_t width = channel_width(scene, channel);
  if (!keys_are_equal(scene, channel, width)) return false;
  const std::uint32_t middle = channel.interpolation == Interpolation::cubic ? width : 0;
  const float* value = scene.key_values.data + channel.value_begin + middle;
  const Vec3 vector = width == 3 ? Vec3{value[0], value[1], value[2]} : Vec3{0, 0, 0};
  switch (channel.path) {
    case ChannelPath::translation:
      return vector == scene.nodes[channel.node].translation;
    case ChannelPath::rotation:
      return is_rotation(channel_rotation(scene, channel, 0), scene.nodes[channel.node].rotation);
    case ChannelPath::scale:
      return vector == scene.nodes[channel.node].scale;
    case ChannelPath::weights:
      return weights_are(scene, channel, value);
    case ChannelPath::visibility:
      return (value[0] >= 0.5f) == (scene.node_visible.empty() || scene.node_visible[channel.node] != 0);
    case ChannelPath::light_intensity:
      return vector == scene.lights[channel.node].intensity;
    case ChannelPath::light_scale:
      return value[0] == 1;
    case ChannelPath::camera_size:
      return value[0] == (scene.cameras[channel.node].projection == Projection::orthographic
                              ? scene.cameras[channel.node].vertical_extent
                              : scene.cameras[channel.node].vertical_fov);
    case ChannelPath::material_diffuse:
      return vector == scene.materials[channel.node].diffuse;
    case ChannelPath::material_emission:
      return vector == scene.materials[channel.node].emission;
  }
  return false;
}

}  // namespace

bool has_one_value(const Scene& scene, const TextureUse& use, std::uint8_t (&value)[4]) {
  bool is_first = true;
  return every_texel(scene, use, [&](const Texel& texel) {
    if (is_first) std::memcpy(value, &texel, sizeof value);
    is_first = false;
    return std::memcmp(value, &texel, sizeof value) == 0;
  });
}

// Returns whether a texture of numbers has no red.
static bool is_without_red(const Scene& scene, const TextureUse& use) {
  return every_texel(scene, use, [](const Texel& t) { return t.r == 0; });
}

static bool is_black(const Scene& scene, const TextureUse& use) {
  return every_texel(scene, use, [](const Texel& t) { return t.r == 0 && t.g == 0 && t.b == 0; });
}

bool shows_emission(const Scene& scene, std::uint32_t material) {
  CHECK_LT(material, scene.materials.count);
  const Material& m = scene.materials[material];
  if (is_zero(m.emission)) return false;
  return m.emission_texture.texture == kNone || !is_black(scene, m.emission_texture);
}

bool shows_holes(const Scene& scene, std::uint32_t material) {
  CHECK_LT(material, scene.materials.count);
  const Material& m = scene.materials[material];
  return m.alpha_mode == AlphaMode::mask && !reaches_alpha(scene, material, m.alpha_cutoff);
}

bool shows_background(const Scene& scene, std::uint32_t material) {
  CHECK_LT(material, scene.materials.count);
  return scene.materials[material].alpha_mode == AlphaMode::blend && !reaches_alpha(scene, material, 1);
}

bool shows_normal_map(const Scene& scene, const TextureUse& normal, float scale) {
  if (normal.texture == kNone || scale == 0) return false;
  return !every_texel(scene, normal, [](const Texel& t) { return t.r == 128 && t.g == 128; });
}

bool shows_occlusion(const Scene& scene, const MaterialMaps& maps) {
  if (maps.occlusion.texture == kNone || maps.occlusion_strength == 0) return false;
  return !every_texel(scene, maps.occlusion, [](const Texel& t) { return t.r == 255; });
}

bool shows_coat(const Scene& scene, const ClearCoat& coat) {
  if (!(coat.strength > 0)) return false;
  return coat.strength_texture.texture == kNone || !is_without_red(scene, coat.strength_texture);
}

bool shows_sheen(const Scene& scene, const Sheen& sheen) {
  if (is_zero(sheen.color)) return false;
  return sheen.color_texture.texture == kNone || !is_black(scene, sheen.color_texture);
}

bool shows_film(const Scene& scene, const Iridescence& film) {
  if (!(film.strength > 0)) return false;
  return film.strength_texture.texture == kNone || !is_without_red(scene, film.strength_texture);
}

bool shows_diffuse_transmission(const Scene& scene, const DiffuseTransmission& passing) {
  if (!(passing.strength > 0)) return false;
  return passing.strength_texture.texture == kNone ||
         !every_texel(scene, passing.strength_texture, [](const Texel& t) { return t.a == 0; });
}

bool shows_grain(const Scene& scene, const Grain& grain) {
  if (grain.direction.x == 0 && grain.direction.y == 0) return false;
  return grain.texture.texture == kNone || !every_texel(scene, grain.texture, [](const Texel& t) { return t.b == 0; });
}

bool shows_vertex_colors(const Scene& scene) {
  if (scene.colors.empty()) return false;
  CHECK_EQ(scene.colors.count, scene.positions.count);
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) {
      const Rgba16& c = scene.colors[v];
      if (c.r != 65535 || c.g != 65535 || c.b != 65535) return true;
    }
  return false;
}

bool passes_unchanged(const Scene& scene, std::uint32_t material) {
  CHECK_LT(material, scene.materials.count);
  const Material& m = scene.materials[material];
  if (m.transmission != Vec3{1, 1, 1} || m.ior != 1 || m.alpha_mode != AlphaMode::opaque) return false;
  if (!m.thin && !is_zero(m.absorption)) return false;
  if (!is_zero(m.diffuse) || !is_zero(m.specular) || !is_zero(m.mirror) || shows_emission(scene, material))
    return false;
  if (scene.sheens.count && shows_sheen(scene, scene.sheens[material])) return false;
  if (scene.iridescences.count && shows_film(scene, scene.iridescences[material])) return false;
  if (scene.glass_maps.count && scene.glass_maps[material].transmission > 0) return false;
  return scene.clear_coats.empty() || !shows_coat(scene, scene.clear_coats[material]);
}

bool shows_vertex_normals(const Scene& scene) {
  if (scene.normals.empty()) return false;
  CHECK_EQ(scene.normals.count, scene.positions.count);
  const bool may_turn = scene.moving_meshes.count > 0;
  if (may_turn && scene.morph_normals.count) return true;
  for (const Vec3& normal : scene.rest_normals)
    if (may_turn && !is_zero(normal)) return true;
  for (const Triangle& t : scene.triangles) {
    const bool is_zero_everywhere = is_zero(scene.normals[t.vertex(0)]) && is_zero(scene.normals[t.vertex(1)]) &&
                                    is_zero(scene.normals[t.vertex(2)]);
    if (!is_zero_everywhere && (may_turn || !is_flat_along_axis(scene, t))) return true;
  }
  return false;
}

bool holds_still(const Scene& scene) {
  for (const Animation& animation : scene.animations)
    for (std::uint32_t c = 0; c < animation.channel_count; ++c)
      if (!holds_target(scene, scene.channels[animation.channel_begin + c])) return false;
  return scene.animations.count > 0 && scene.channels.count > 0;
}

Box triangle_bounds(const Scene& scene) {
  Box box = empty_box();
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) box = merge(box, scene.positions[v]);
  return box;
}

bool is_out_of_range(const Scene& scene, const Box& bounds, const Light& light) {
  if (light.kind == LightKind::directional || !(light.range > 0)) return false;
  if (light.node != kNone || scene.moving_meshes.count > 0) return false;
  const Vec3& point = light.position;
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = static_cast<double>(bounds.low[axis]) - static_cast<double>(point[axis]),
                 above = static_cast<double>(point[axis]) - static_cast<double>(bounds.high[axis]);
    const double outside = below > 0 ? below : above > 0 ? above : 0;
    square += outside * outside;
  }
  // Kernels compare squares in floats: leaves room for their rounding.
  return std::sqrt(square) >= static_cast<double>(light.range) * (1 + 0x1p-20);
}

}  // namespace pocketray
