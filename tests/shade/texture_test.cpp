#include <doctest/doctest.h>

#include "base/color.h"
#include "base/rng.h"
#include "scene/texel_blocks.h"
#include "shade/shade_helpers.h"
#include "shade/texture.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

const std::vector<std::array<int, 4>> kTwoByTwo = {
    {{255, 0, 0, 255}}, {{0, 255, 0, 128}}, {{0, 0, 255, 64}}, {{255, 255, 255, 0}}};

struct Sampled {
  Vec3 rgb;
  float alpha;
};
Sampled at(float u, float v, Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat, bool nearest = false,
           TextureFilter filter = TextureFilter::as_scene) {
  GeneratedScene s;
  TextureUse use;
  use.texture = add_texture(&s, 2, 2, kTwoByTwo, wrap_u, wrap_v, nearest);
  s.bind();
  Rgba c = sample_texture(s.scene, use, {u, v}, filter);
  return {c.rgb, c.alpha};
}

}  // namespace

// Goal: a look-up at a texel's centre gives the texel, row 0 at v = 0. Method: closed form, both filters.
TEST_CASE("texture_centres_give_texels") {
  for (bool nearest : {true, false}) {
    CHECK(at(.25f, .25f, Wrap::repeat, Wrap::repeat, nearest).rgb == Vec3{1, 0, 0});
    CHECK(at(.75f, .25f, Wrap::repeat, Wrap::repeat, nearest).rgb == Vec3{0, 1, 0});
    CHECK(at(.25f, .75f, Wrap::repeat, Wrap::repeat, nearest).rgb == Vec3{0, 0, 1});
    CHECK(at(.75f, .75f, Wrap::repeat, Wrap::repeat, nearest).rgb == Vec3{1, 1, 1});
  }
  CHECK(at(.75f, .25f).alpha == 128 / 255.0f);
}

// Goal: between centres colours mix linearly, in linear light. Method: closed form half-way and at a quarter.
TEST_CASE("texture_bilinear_mixes_linear_light") {
  CHECK(at(.5f, .25f).rgb == Vec3{.5f, .5f, 0});
  CHECK(at(.375f, .25f).rgb == Vec3{.75f, .25f, 0});
  CHECK(at(.5f, .5f).rgb == Vec3{.5f, .5f, .5f});
  CHECK(at(.5f, .5f).alpha == doctest::Approx((255 + 128 + 64) / 4.0 / 255));
}

// Goal: coordinates wrap as the sampler specifies. Method: closed form beyond the edges, near and far.
TEST_CASE("texture_wraps") {
  for (float turns : {-3.0f, -1.0f, 1.0f, 2.0f, 1000.0f}) {
    CAPTURE(turns);
    CHECK(at(.25f + turns, .75f).rgb == Vec3{0, 0, 1});
    bool odd = static_cast<int>(turns) % 2 != 0;
    CHECK(at(.25f + turns, .25f, Wrap::mirror).rgb == (odd ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
    CHECK(at(.25f + turns, .25f, Wrap::clamp).rgb == (turns < 0 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    CHECK(at(.25f, .25f + turns, Wrap::repeat, Wrap::clamp).rgb == (turns < 0 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}));
  }
  CHECK(at(0, .25f).rgb == Vec3{.5f, .5f, 0});  // the seam mixes with the other edge
  CHECK(at(0, .25f, Wrap::clamp).rgb == Vec3{1, 0, 0});
  CHECK(at(0, .25f, Wrap::mirror).rgb == Vec3{1, 0, 0});
  for (float wild : {1e30f, -1e30f, 1e9f}) CHECK(is_finite(at(wild, wild).rgb));
}

// Goal: integer texel coordinates saturate: the last texel beyond the far edge, the first before the near one, any
// texel of a repeated texture. Method: coordinates up to the largest that a scene may hold, both filters.
TEST_CASE("hard_62_texture_coordinates_saturate") {
  const float values[] = {0.0f, 1e-45f, 0.99f, 1.5f, 1e6f, 1e9f, 2147483648.0f, 4.3e9f, 1e18f};
  std::uint64_t wrong = 0, tried = 0;
  for (bool nearest : {false, true})
    for (float value : values)
      for (Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
        for (float u : {value, -value}) {
          Vec3 color = at(u, 0.25f, wrap, Wrap::clamp, nearest).rgb;  // the upper row: red, then green
          bool right = std::fabs(color.x + color.y - 1) < 1e-6f && color.z == 0;
          if (wrap == Wrap::clamp && u >= 1) right = color == Vec3{0, 1, 0};
          if (wrap == Wrap::clamp && u <= 0) right = color == Vec3{1, 0, 0};
          wrong += !right, ++tried;
        }
  CHECK(wrong == 0);
  count_hard(tried, wrong, "saturates");
}

// Goal: the settings' filter overrides the scene's. Method: a point where the two differ.
TEST_CASE("texture_filter_can_be_overridden") {
  CHECK(at(.45f, .25f, Wrap::repeat, Wrap::repeat, false, TextureFilter::nearest).rgb == Vec3{1, 0, 0});
  CHECK(at(.5f, .25f, Wrap::repeat, Wrap::repeat, true, TextureFilter::bilinear).rgb == Vec3{.5f, .5f, 0});
}

// Goal: a texture in blocks is sampled as the exact one of its decoded texels, at every level, with every filter, bit
// for bit. Method: random blocks of every format, odd sizes, random places and footprints, both kinds of look-up.
TEST_CASE("texture_in_blocks_is_that_of_its_texels") {
  Rng rng = make_rng(12);
  for (int format = 1; format < kTexelFormatCount; ++format)
    for (std::uint16_t width : {1, 4, 13, 32})
      for (std::uint16_t height : {3, 8, 21}) {
        Texture blocks = {0, width, height, Wrap::repeat, Wrap::mirror, 0, 1, static_cast<TexelFormat>(format)};
        blocks.level_count = static_cast<std::uint8_t>(level_count_max(width, height));
        Texture exact = blocks;
        exact.format = TexelFormat::exact;
        const std::uint32_t words = block_words(blocks.format);
        std::vector<std::uint32_t> stored(level_words(blocks.format, width, height, blocks.level_count)), texels;
        for (std::uint32_t& word : stored) word = next_u32(&rng);
        for (std::uint32_t level = 0; level < blocks.level_count; ++level) {
          const std::uint32_t* begin = stored.data() + level_words(blocks.format, width, height, level);
          const std::uint32_t across = block_count(blocks.format, level_side(width, level));
          for (std::uint32_t y = 0; y < level_side(height, level); ++y)
            for (std::uint32_t x = 0; x < level_side(width, level); ++x)
              texels.push_back(block_texel(blocks.format, begin + (y / 4 * across + x / 4) * words, y % 4 * 4 + x % 4));
        }
        Scene a, b;
        a.textures = {&blocks, 1}, a.texels = {stored.data(), static_cast<std::uint32_t>(stored.size())};
        b.textures = {&exact, 1}, b.texels = {texels.data(), static_cast<std::uint32_t>(texels.size())};
        TextureUse use;
        use.texture = 0;
        int unequal = 0;
        for (int i = 0; i < 200; ++i) {
          const Vec2 uv = {next_float(&rng) * 4 - 2, next_float(&rng) * 4 - 2};
          const Footprint area = {next_float(&rng) * next_float(&rng) * next_float(&rng),
                                  {next_float(&rng) - 0.5f, next_float(&rng) - 0.5f}};
          const auto filter = static_cast<TextureFilter>(next_u32(&rng) % 5);
          const Rgba p = sample_texture(a, use, uv, filter, area), q = sample_texture(b, use, uv, filter, area);
          unequal += !(p.rgb == q.rgb && p.alpha == q.alpha);
          unequal += !(sample_numbers(a, use, uv, filter) == sample_numbers(b, use, uv, filter));
        }
        CAPTURE(format);
        CAPTURE(width);
        CHECK(unequal == 0);
      }
}

// Goal: textures reach the picture in the right place: uv, transform and base colour. Method: rays at texel centres of
// a textured, unlit square.
TEST_CASE("texture_shows_on_a_square") {
  GeneratedScene s;
  Material m;
  m.unlit = 1;
  m.diffuse = {0.5f, 1, 0.25f};
  m.diffuse_texture.texture = add_texture(&s, 2, 2, kTwoByTwo);
  add_sheet(&s, 0, add_material(&s, m), false, 1);
  s.with_uvs = true;
  auto t = ray_renderer(&s);
  CHECK(look(*t, {-.5f, -.5f, 1}, {-.5f, -.5f, 0}) == Vec3{.5f, 0, 0});
  CHECK(look(*t, {.5f, -.5f, 1}, {.5f, -.5f, 0}) == Vec3{0, 1, 0});
  CHECK(look(*t, {.5f, .5f, 1}, {.5f, .5f, 0}) == Vec3{.5f, 1, .25f});
  s.materials[0].diffuse_texture.m[0][2] = 0.5f;  // shifted by one texel
  CHECK(look(*ray_renderer(&s), {-.5f, -.5f, 1}, {-.5f, -.5f, 0}) == Vec3{0, 1, 0});
}

// Goal: with emission forced off, an unlit surface is lit like any other. Method: the same square with and without the
// flag, in a light and its shadow, bit for bit; with emission it shows its colour.
TEST_CASE("unlit_without_emission_is_lit_like_others") {
  auto square = [](std::uint8_t is_unlit, EffectMask forced_off) {
    GeneratedScene s;
    Material m;
    m.unlit = is_unlit;
    m.diffuse = {0.5f, 1, 0.25f};
    add_sheet(&s, 0, add_material(&s, m), false, 1);
    add_sheet(&s, 1, add_material(&s, m), false, 0.3f);
    Light light;
    light.position = {1, 0.5f, 3}, light.intensity = {9, 9, 9};
    s.lights.push_back(light);
    s.scene.info.ambient = {2, 2, 2};
    aim(&s, {0, 0, 4}, {0, 0, 0}, 60);
    s.bind();
    Settings settings;
    settings.width = 24, settings.height = 18, settings.forced_off = forced_off;
    return render_picture(s.scene, settings, 0);
  };
  Picture lit = square(0, 0);
  CHECK(same_picture(square(1, bit(Effect::emission)), square(0, bit(Effect::emission))));
  CHECK_FALSE(same_picture(square(1, 0), lit));
  CHECK(square(1, 0)[24 * 9 + 12] == Vec3{0.5f, 1, 0.25f});
}

// Goal: vertex colours interpolate. Method: closed form at the mean of the vertices.
TEST_CASE("vertex_colors_interpolate") {
  GeneratedScene s;
  Material m;
  m.unlit = 1;
  m.diffuse = {1, 1, 1};
  add_sheet(&s, 0, add_material(&s, m), false, 1);
  s.colors = {{0, 65535, 0, 65535}, {65535, 65535, 0, 65535}, {65535, 65535, 65535, 65535}, {0, 65535, 65535, 65535}};
  s.with_colors = true;
  auto t = ray_renderer(&s);
  for (float x : {-.8f, 0.1f, .6f})
    for (float y : {-.5f, 0.2f, .9f}) {
      Vec3 seen = look(*t, {x, y, 1}, {x, y, 0});
      CHECK(seen.x == doctest::Approx((x + 1) / 2).epsilon(1e-5));
      CHECK(seen.y == doctest::Approx(1));
      CHECK(seen.z == doctest::Approx((y + 1) / 2).epsilon(1e-5));
    }
}

// Goal: below its cut-off a surface has a hole, for the eye and for light; above, it is whole. Method: closed form.
TEST_CASE("alpha_mask_cuts_holes") {
  for (float opacity : {0.4f, 0.6f}) {
    GeneratedScene s;
    Material holes = unlit(1);
    holes.alpha_mode = AlphaMode::mask;
    holes.opacity = opacity;
    add_sheet(&s, 1, add_material(&s, holes));
    add_sheet(&s, 0, add_material(&s, matte(0.8f)));
    Light light;
    light.kind = LightKind::directional;
    light.direction = {0, 0, -1};
    s.lights.push_back(light);
    auto t = ray_renderer(&s);
    bool hole = opacity < 0.5f;
    CHECK(look(*t, {0.1f, 0.2f, 2}, {0.1f, 0.2f, 0}).x == doctest::Approx(hole ? 0.8 / kPiD : 1.0));
    CHECK(look(*t, {0.1f, 0.2f, 0.5f}, {0.1f, 0.2f, 0}).x == doctest::Approx(hole ? 0.8 / kPiD : 0.0));
  }
}

// Goal: blending surfaces mix with what is behind them, even if coincident, and pass 1 − α of the light. Method: closed
// form, two layers in front of an opaque one, apart and coincident, in every order of their triangles. Of coincident
// surfaces the first in the list is hit first: an opaque one hides surfaces laid upon it later.
TEST_CASE("alpha_blend_mixes_with_what_is_behind") {
  for (float gap : {1.0f, 0.0f})
    for (int order = 0; order < 3; ++order) {
      GeneratedScene s;
      auto layer = [&](float radiance, float opacity, float z) {
        Material m = unlit(radiance);
        if (opacity < 1) m.alpha_mode = AlphaMode::blend, m.opacity = opacity;
        add_sheet(&s, z, add_material(&s, m));
      };
      if (order == 0) layer(0.25f, 1, 1);
      layer(1, 0.25f, 1 + 2 * gap);
      if (order == 1) layer(0.25f, 1, 1);
      layer(0.5f, 0.5f, 1 + gap);
      if (order == 2) layer(0.25f, 1, 1);
      CAPTURE(gap);
      CAPTURE(order);
      CHECK(look(*ray_renderer(&s), {0.1f, 0.2f, 5}, {0.1f, 0.2f, 0}).x ==
            doctest::Approx(gap == 0 && order == 0 ? 0.25 : 0.25 + 0.75 * (0.25 + 0.5 * 0.25)));
    }
  GeneratedScene s;
  Material m = matte(1);
  m.alpha_mode = AlphaMode::blend, m.opacity = 0.25f;
  add_sheet(&s, 1, add_material(&s, m));
  add_sheet(&s, 0, add_material(&s, matte(0.8f)));
  Light light;
  light.kind = LightKind::directional;
  light.direction = {0, 0, -1};
  s.lights.push_back(light);
  CHECK(look(*ray_renderer(&s), {0, 0.1f, 0.5f}, {0, 0.1f, 0}).x == doctest::Approx(0.75 * 0.8 / kPiD));
}
