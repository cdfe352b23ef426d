// Contents that no picture shows, at the level of texels and keys.
#include "scene/invisible.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "scene/baked.h"
#include "scene/texel_blocks.h"

using namespace pocketray;

namespace {

// A scene with one texture of 6 × 5 texels with three levels, in any format.
struct TexturedScene {
  Scene scene;
  std::vector<std::uint32_t> exact, stored;
  Texture texture = {0, 6, 5, Wrap::repeat, Wrap::repeat, 0, 3};
  TextureUse use;

  TexturedScene(TexelFormat format, std::uint32_t value, int odd_texel, std::uint32_t odd_value) {
    exact.assign(level_texels(6, 5, 3), value);
    if (odd_texel >= 0) exact[static_cast<std::size_t>(odd_texel)] = odd_value;
    texture.format = format;
    stored = exact;
    if (format != TexelFormat::exact) {
      stored.assign(level_words(format, 6, 5, 3), 0);
      std::uint32_t from = 0, to = 0;
      for (std::uint32_t level = 0; level < 3; ++level) {
        const std::uint32_t width = level_side(6, level), height = level_side(5, level);
        encode_blocks(format, exact.data() + from, width, height, stored.data() + to);
        from += width * height;
        to += block_count(format, width) * block_count(format, height) * block_words(format);
      }
    }
    scene.textures = {&texture, 1};
    scene.texels = {stored.data(), static_cast<std::uint32_t>(stored.size())};
    use.texture = 0;
  }
};

}  // namespace

// Goal: one texel that differs is found, wherever it is and however it is stored. Method: white occlusion with one dark
// texel in each place of each level, exact and in blocks.
TEST_CASE("invisible_every_texel_is_read") {
  for (const TexelFormat format : {TexelFormat::exact, TexelFormat::red4, TexelFormat::numbers12}) {
    CAPTURE(static_cast<int>(format));
    MaterialMaps maps;
    maps.occlusion.texture = 0;
    CHECK_FALSE(shows_occlusion(TexturedScene(format, 0xFFFFFFFF, -1, 0).scene, maps));
    const int count = static_cast<int>(level_texels(6, 5, 3));
    for (int odd = 0; odd < count; ++odd) {
      CAPTURE(odd);
      CHECK(shows_occlusion(TexturedScene(format, 0xFFFFFFFF, odd, 0xFFFFFF00).scene, maps));
    }
  }
}

// Goal: a texture of one value is recognised by all of its channels. Method: equal texels; one that differs in a single
// channel.
TEST_CASE("invisible_one_value_has_four_channels") {
  std::uint8_t value[4] = {};
  const TexturedScene even(TexelFormat::exact, 0x04030201, -1, 0);
  REQUIRE(has_one_value(even.scene, even.use, value));
  for (int c = 0; c < 4; ++c) CHECK(value[c] == c + 1);
  for (int c = 0; c < 4; ++c) {
    const TexturedScene odd(TexelFormat::exact, 0x04030201, 7, 0x04030201 ^ 1u << 8 * c);
    CHECK_FALSE(has_one_value(odd.scene, odd.use, value));
  }
}

// Goal: an animation changes nothing if and only if every key has the value at rest. Method: a translation by each kind
// of interpolation, with one number changed at a time; tangents of splines count.
TEST_CASE("invisible_animations_hold_every_number") {
  for (const Interpolation interpolation : {Interpolation::step, Interpolation::linear, Interpolation::cubic}) {
    const bool is_cubic = interpolation == Interpolation::cubic;
    Node node;
    node.translation = {1, 2, 3};
    const std::vector<float> times = {0, 1};
    std::vector<float> values;
    for (int key = 0; key < 2; ++key) {
      if (is_cubic) values.insert(values.end(), {0, 0, 0});
      values.insert(values.end(), {1, 2, 3});
      if (is_cubic) values.insert(values.end(), {0, 0, 0});
    }
    Channel channel = {};
    channel.key_count = 2, channel.path = ChannelPath::translation, channel.interpolation = interpolation;
    const Animation animation = {0, 1, 1};
    Scene scene;
    scene.animations = {&animation, 1};
    scene.nodes = {&node, 1}, scene.channels = {&channel, 1};
    scene.key_times = {times.data(), 2};
    scene.key_values = {values.data(), static_cast<std::uint32_t>(values.size())};
    CHECK(holds_still(scene));
    for (float& number : values) {
      const float before = number;
      number += 0x1p-20f;
      CHECK_FALSE(holds_still(scene));
      number = before;
    }
    node.translation.z = 3.5f;
    CHECK_FALSE(holds_still(scene));
    const Animation empty = {0, 0, 1};
    scene.channels = {}, scene.animations = {&empty, 1};
    CHECK_FALSE(holds_still(scene));
  }
}

// Goal: a file that names an unknown kind of reduction is refused. Method: the first kind beyond the last.
TEST_CASE("invisible_kinds_are_validated") {
  const Vec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Triangle triangle(0, 1, 2, 0);
  const Material material;
  Reduction reduction = {static_cast<Invisible>(kInvisibleCount - 1), 3};
  Scene scene;
  scene.positions = {positions, 3}, scene.triangles = {&triangle, 1}, scene.materials = {&material, 1};
  scene.reductions = {&reduction, 1};
  CHECK(validate_scene(scene).ok);
  reduction.what = static_cast<Invisible>(kInvisibleCount);
  CHECK(std::string(validate_scene(scene).message) == "reductions[0] is of kind 21, there are 21");
}
