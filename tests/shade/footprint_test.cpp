// Levels of textures by the footprint of a pixel.
#include "shade/footprint.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "base/color.h"
#include "base/fmath.h"
#include "scene/texture_levels.h"
#include "shade/shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kSide = 128, kLevels = 8;  // of the texture below

// A texture whose level k is of one colour, (k + 1)/8 in linear light to within a display level: what is seen tells the
// level.
float value_of(std::uint32_t level) {
  return srgb_to_linear(srgb_level(static_cast<float>(level + 1) / static_cast<float>(kLevels)));
}
std::uint32_t add_level_texture(GeneratedScene* s, int alpha = 255) {
  std::vector<std::array<int, 4>> base(kSide * kSide, {{0, 0, 0, alpha}});
  const std::uint32_t texture = add_texture(s, kSide, kSide, base);
  add_levels(s, texture);
  Texture& t = s->textures[texture];
  REQUIRE(t.level_count == kLevels);
  for (std::uint32_t level = 0; level < kLevels; ++level) {
    const std::uint8_t byte = srgb_level(static_cast<float>(level + 1) / static_cast<float>(kLevels));
    for (std::uint32_t i = level_texels(kSide, kSide, level); i < level_texels(kSide, kSide, level + 1); ++i)
      s->texels[t.texel_begin + i] = byte * 0x10101u | static_cast<std::uint32_t>(alpha) << 24;
  }
  return texture;
}

Material showing(std::uint32_t texture) {
  Material m = unlit(1);
  m.diffuse = {1, 1, 1};
  m.diffuse_texture.texture = texture;
  return m;
}

// At a distance of 20 · scale, a pixel of the camera below is as wide as a texel of a sheet of side 10 · scale.
std::unique_ptr<TestRenderer> level_renderer(GeneratedScene* s, float scale = 1, std::uint32_t samples = 1,
                                             TextureFilter filter = TextureFilter::as_scene) {
  s->with_uvs = true;
  aim(s, Vec3{0.1f, 0.2f, 50} * scale, {0, 0, 0}, 90);
  s->lights.resize(1);
  s->lights[0].intensity = {0, 0, 0};
  s->bind();
  Settings settings;
  settings.width = settings.height = 256;
  settings.samples_per_pixel = samples, settings.texture_filter = filter;
  settings.cut_off_levels = 0, settings.ray_depth = 16;
  return make_renderer(s->scene, settings);
}

// What a ray straight down at a textured sheet sees from the height.
float seen(float height, float scale = 1, std::uint32_t samples = 1, TextureFilter filter = TextureFilter::as_scene) {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, showing(add_level_texture(&s))), false, 10 * scale);
  return look(*level_renderer(&s, scale, samples, filter), Vec3{1, 2, height} * scale, Vec3{1, 2, 0} * scale).x;
}

}  // namespace

// Goal: ½ log₂ of a number of texels, exact for powers of two, never below 0. Method: against det_log; every special
// value.
TEST_CASE("texture_level_is_half_the_logarithm") {
  for (int k = 0; k < 60; ++k)
    CHECK(texture_level(static_cast<float>(std::uint64_t(1) << k)) == 0.5f * static_cast<float>(k));
  float before = 0, worst = 0;
  for (float x = 1; x < 1e9f; x *= 1.003f) {
    const float level = texture_level(x);
    CHECK(level >= before);
    worst = std::max(worst, std::fabs(level - static_cast<float>(0.5 * det_log(static_cast<double>(x)) / det_log(2))));
    before = level;
  }
  MESSAGE("largest error of a level: ", worst);
  CHECK(worst < 0.0005f);
  for (float x : {0.0f, -3.0f, 0.999f, 1.0f, std::numeric_limits<float>::quiet_NaN()}) CHECK(texture_level(x) == 0);
  CHECK(texture_level(std::numeric_limits<float>::infinity()) == 64);
}

// Goal: the level of a plane seen perpendicularly from the distance d is log₂(d/d₀), where a pixel is as wide as a
// texel at d₀; closer, it is 0. Method: closed form with a texture whose colours tell the level; half-way between two
// levels, their mean.
TEST_CASE("footprint_of_a_plane_grows_with_the_distance") {
  for (std::uint32_t level = 0; level < kLevels; ++level) {
    CAPTURE(level);
    CHECK(seen(20 * static_cast<float>(1u << level)) == doctest::Approx(value_of(level)));
  }
  CHECK(seen(5) == value_of(0));
  CHECK(seen(20e6f) == value_of(kLevels - 1));
  const float between = 40 * 1.41421356f;
  CHECK(seen(between) == doctest::Approx((value_of(1) + value_of(2)) / 2).epsilon(2e-3));
}

// Goal: a scene scaled by a power of two shows the same level. Method: pictures of single rays, bit for bit, to the
// ends of the range of floats.
TEST_CASE("footprint_does_not_depend_on_the_scale") {
  for (float height : {13.0f, 47.0f, 61.0f, 333.0f})
    for (float scale : {0x1p-40f, 0x1p-20f, 0.5f, 0x1p20f, 0x1p40f}) {
      CAPTURE(height);
      CAPTURE(scale);
      CHECK(seen(height, scale) == seen(height));
    }
}

// Goal: a sample's footprint is its share of the pixel's: with four samples, one level finer. Method: closed form.
TEST_CASE("footprint_is_divided_among_samples") {
  CHECK(seen(80, 1, 4) == doctest::Approx(value_of(1)));
  CHECK(seen(80, 1, 16) == doctest::Approx(value_of(0)));
}

// Goal: the footprint is an area, larger by 1/cosine where the surface is inclined. Method: at 60°, half a level more.
TEST_CASE("footprint_of_an_inclined_plane_is_larger") {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, showing(add_level_texture(&s))), false, 10);
  auto t = level_renderer(&s);
  const Vec3 way = {0.8660254f, 0, 0.5f}, point = {1, 2, 0};
  CHECK(look(*t, point + way * 40.0f, point).x == doctest::Approx((value_of(1) + value_of(2)) / 2).epsilon(2e-3));
}

// Goal: the filters nearest and bilinear read full-size texels, trilinear and the scene's own the levels. Method: the
// same place with each.
TEST_CASE("footprint_counts_with_filters_that_take_levels") {
  CHECK(seen(80, 1, 1, TextureFilter::nearest) == value_of(0));
  CHECK(seen(80, 1, 1, TextureFilter::bilinear) == value_of(0));
  CHECK(seen(80, 1, 1, TextureFilter::trilinear) == seen(80));
}

// Goal: the cone grows along the whole path: by way of a plane mirror, through glass that does not bend, a blending
// surface without opacity, or the back of a one-sided one, a texture is seen at the level of the straight path. Method:
// paths of equal length with and without the obstacle.
TEST_CASE("footprint_grows_along_the_whole_path") {
  Material mirror = matte(0), pane = glass(1), veil = matte(1), back = matte(1);
  mirror.mirror = {1, 1, 1};
  pane.thin = 1;
  veil.alpha_mode = AlphaMode::blend, veil.opacity = 0;
  back.double_sided = 0;
  for (float distance : {40.0f, 67.0f, 90.0f, 160.0f}) {
    CAPTURE(distance);
    GeneratedScene folded;  // the eye is between the mirror and the texture
    add_sheet(&folded, distance - 15, add_material(&folded, showing(add_level_texture(&folded))), true);
    add_sheet(&folded, 0, add_material(&folded, mirror), false, 1);
    CHECK(look(*level_renderer(&folded), {.25f, .5f, 15}, {.25f, .5f, 0}).x ==
          doctest::Approx(seen(distance)).epsilon(1e-5));
    for (const Material& between : {pane, veil, back}) {
      GeneratedScene straight;
      add_sheet(&straight, 0, add_material(&straight, showing(add_level_texture(&straight))));
      add_sheet(&straight, 7, add_material(&straight, between), true);
      add_sheet(&straight, 9, add_material(&straight, between), true);
      CHECK(look(*level_renderer(&straight), {1, 2, distance}, {1, 2, 0}).x ==
            doctest::Approx(seen(distance)).epsilon(1e-5));
    }
  }
}

// Goal: cut-out holes and shadows do not change with the level, so that neither grows or vanishes in the distance.
// Method: a sheet with a hole in every other texel, from so far that its levels have no hole; the share of rays that
// meet it is that of level 0.
TEST_CASE("footprint_leaves_holes_as_they_are") {
  GeneratedScene s;
  std::vector<std::array<int, 4>> board(kSide * kSide);
  for (std::uint32_t i = 0; i < board.size(); ++i) board[i] = {{255, 255, 255, (i + i / kSide) % 2 ? 255 : 0}};
  Material m = showing(add_texture(&s, kSide, kSide, board, Wrap::repeat, Wrap::repeat, true));
  add_levels(&s, m.diffuse_texture.texture);
  m.alpha_mode = AlphaMode::mask;
  add_sheet(&s, 0, add_material(&s, m), false, 10);
  auto t = level_renderer(&s);
  int met = 0;
  Rng rng = make_rng(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 point = {next_float(&rng) * 18 - 9, next_float(&rng) * 18 - 9, 0};
    met += look(*t, point + Vec3{0, 0, 500}, point).x > 0;
  }
  CHECK(std::abs(met - 1000) < 100);
}

// Goal: the anisotropic filter reads an inclined plane at the level of its shorter axis, up to a ratio of 4; beyond, a
// quarter of the area counts. Method: closed form at the cosines 1, 1/2, 1/4 and 1/16.
TEST_CASE("anisotropic_filter_keeps_the_level_of_the_shorter_axis") {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, showing(add_level_texture(&s))), false, 10);
  auto t = level_renderer(&s, 1, 1, TextureFilter::anisotropic);
  const struct {
    float cosine;
    std::uint32_t level;
  } cases[] = {{1, 1}, {0.5f, 1}, {0.25f, 1}, {0.0625f, 2}};
  for (const auto& c : cases) {
    CAPTURE(c.cosine);
    const Vec3 way = {std::sqrt(1 - c.cosine * c.cosine), 0, c.cosine}, point = {1, 2, 0};
    CHECK(look(*t, point + way * 40.0f, point).x == doctest::Approx(value_of(c.level)).epsilon(1e-3));
  }
}

namespace {

// A chequered floor in perspective: the picture at one sample a pixel, and its RMSE against 16 × 16 bilinear samples, 8
// × 8 under emulation.
class Floor {
 public:
  // `m` transforms the texture coordinates, which run from 0 to 1 over the floor.
  explicit Floor(const float (&m)[2][2]) {
    std::vector<std::array<int, 4>> board(64 * 64);
    for (int i = 0; i < 64 * 64; ++i) {
      const int level = (i / 4 + i / 256) % 2 ? 220 : 40;
      board[static_cast<std::size_t>(i)] = {{level, level, level, 255}};
    }
    Material material = showing(add_texture(&s_, 64, 64, board));
    add_levels(&s_, material.diffuse_texture.texture);
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 2; ++column) material.diffuse_texture.m[row][column] = m[row][column];
    add_quad(&s_, {-20, 0, 20}, {20, 0, 20}, {20, 0, -20}, {-20, 0, -20}, add_material(&s_, material));
    s_.with_uvs = true;
    s_.lights.resize(1);
    aim(&s_, {0, 3, 18}, {0, 0, 4}, 50);
    s_.bind();
    constexpr std::uint32_t kFine = kEffortDivisor > 1 ? 8 : 16;
    const Picture fine = picture(kFine, TextureFilter::bilinear);
    mean_.resize(kWidth * kHeight);
    for (std::uint32_t y = 0; y < kHeight * kFine; ++y)
      for (std::uint32_t x = 0; x < kWidth * kFine; ++x)
        mean_[y / kFine * kWidth + x / kFine] += static_cast<double>(fine[y * kWidth * kFine + x].x) / (kFine * kFine);
  }

  double rmse(TextureFilter filter) const {
    const Picture coarse = picture(1, filter);
    double sum = 0;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      const double off = static_cast<double>(coarse[i].x) - mean_[i];
      sum += off * off;
    }
    return std::sqrt(sum / static_cast<double>(mean_.size()));
  }

 private:
  static constexpr std::uint32_t kWidth = 64, kHeight = 48;
  GeneratedScene s_;
  std::vector<double> mean_;

  Picture picture(std::uint32_t scale, TextureFilter filter) const {
    Settings settings;
    settings.width = kWidth * scale, settings.height = kHeight * scale, settings.texture_filter = filter;
    return render_picture(s_.scene, settings, 0);
  }
};

}  // namespace

// Goal: at one sample, trilinear comes closer to the picture of many samples than bilinear does. Method: RMSE, which
// must at least halve.
TEST_CASE("footprint_brings_a_picture_closer_to_one_of_many_samples") {
  const Floor floor({{6, 0}, {0, 6}});
  const double bilinear = floor.rmse(TextureFilter::bilinear), trilinear = floor.rmse(TextureFilter::trilinear);
  MESSAGE("RMSE of bilinear ", bilinear, ", of trilinear ", trilinear);
  CHECK(trilinear < bilinear / 2);
}

// Goal: the anisotropic filter comes closer still: it follows the footprint of a floor, whatever the texture's
// transform. Method: RMSE with the texture turned, mirrored and stretched.
TEST_CASE("anisotropic_filter_follows_the_direction_of_view") {
  const float transforms[][2][2] = {{{6, 0}, {0, 6}}, {{4, 4.5f}, {-4.5f, 4}}, {{-5, 3}, {3, 5}}, {{4, 0}, {0, 9}}};
  for (const auto& m : transforms) {
    CAPTURE(m[0][0]);
    const Floor floor(m);
    const double trilinear = floor.rmse(TextureFilter::trilinear), along = floor.rmse(TextureFilter::anisotropic);
    MESSAGE("RMSE of trilinear ", trilinear, ", of anisotropic ", along);
    CHECK(along < 0.85 * trilinear);
  }
}
