// Black pictures and their causes.
#include "session/black_picture.h"

#include <doctest/doctest.h>

#include <string>

#include "scene/builtin/builtin.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr Vec3 kGrey = {0.5f, 0.5f, 0.5f}, kNothing = {0, 0, 0};

Material scattering(const Vec3& diffuse) {
  Material m;
  m.diffuse = diffuse;
  return m;
}

// A wall that fills `share` of the picture's surfaces from the left, beside a grey one, and a light in front of both.
std::unique_ptr<GeneratedScene> two_walls(const Material& left, float share) {
  auto s = std::make_unique<GeneratedScene>();
  const std::uint32_t first = add_material(s.get(), left), second = add_material(s.get(), scattering(kGrey));
  const float edge = 8 * share - 4;
  add_quad(s.get(), {-4, -3, 0}, {edge, -3, 0}, {edge, 3, 0}, {-4, 3, 0}, first);
  add_quad(s.get(), {edge, -3, 0}, {4, -3, 0}, {4, 3, 0}, {edge, 3, 0}, second);
  aim(s.get(), {0, 0, 8}, {0, 0, 0}, 41);
  Light light;
  light.position = {0, 0, 6}, light.intensity = {30, 30, 30};
  s->lights.push_back(light);
  return s;
}

// The explanation of the scene's picture; empty: none. `off`: effects that are switched off.
std::string explanation(GeneratedScene* s, const std::vector<std::string>& names = {}, EffectMask off = 0) {
  s->bind();
  Settings settings;
  settings.width = 64, settings.height = 48, settings.threads = 1, settings.forced_off = off;
  auto test = make_renderer(s->scene, settings);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  const Picture before(test->renderer.image.begin(), test->renderer.image.end());
  char text[kBlackTextBytes];
  const bool is_black = explain_black(test->renderer, names, text);
  CHECK(is_black == (text[0] != 0));
  CHECK(same_picture(before, Picture(test->renderer.image.begin(), test->renderer.image.end())));
  return text;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

// Goal: a material that reflects nothing is named, from a quarter of the surfaces on. Method: shares around a quarter,
// with and without a name; a material whose vertex colours are black.
TEST_CASE("black_material_is_named") {
  auto few = two_walls(scattering(kNothing), 0.2f), many = two_walls(scattering(kNothing), 0.35f);
  CHECK(explanation(few.get()).empty());
  std::string text = explanation(many.get());
  CHECK(has(text, "material 1 of 2 reflects nothing"));
  CHECK((has(text, "34 %") || has(text, "35 %") || has(text, "36 %")));
  CHECK(has(explanation(many.get(), {"Body"}), "material 'Body' reflects nothing"));
  auto colored = two_walls(scattering(kGrey), 0.5f);
  colored->colors.assign(colored->positions.size(), Rgba16{65535, 65535, 65535, 65535});
  for (int i = 0; i < 4; ++i) colored->colors[static_cast<std::size_t>(i)] = {0, 0, 0, 65535};
  colored->with_colors = true;
  CHECK(has(explanation(colored.get()), "vertex colours of material 1 of 2 are black"));
}

// Goal: metals and mirrors in black surroundings are told from black materials. Method: a mirror; the same before a
// grey background.
TEST_CASE("black_surroundings_of_a_mirror_are_told") {
  Material mirror = scattering(kNothing);
  mirror.mirror = {0.9f, 0.9f, 0.9f};
  auto s = two_walls(mirror, 0.5f);
  CHECK(has(explanation(s.get()),
            "material 1 of 2 is a metal or mirror, and what it reflects is black; try --background"));
  s->scene.info.background = kGrey;
  CHECK(explanation(s.get()).empty());
}

// Goal: where light does not get, the reason is told, but shadows of up to half the surfaces are a matter of taste.
// Method: a screen before the light; a light out of range, and with one behind; the camera in a closed body.
TEST_CASE("black_for_lack_of_light_is_explained") {
  auto out_of_range = two_walls(scattering(kGrey), 0.5f);
  out_of_range->lights[0].range = 1;
  CHECK(
      has(explanation(out_of_range.get()), "100 % of the surfaces in the picture are exactly black: they are out of"));
  auto screened = two_walls(scattering(kGrey), 0.5f);
  screened->lights[0].position = {0, 0, 20}, screened->lights[0].intensity = {900, 900, 900};
  add_quad(screened.get(), {-9, -9, 12}, {9, -9, 12}, {9, 9, 12}, {-9, 9, 12}, 1);
  CHECK(has(explanation(screened.get()), "all light on its way there is blocked; move the lights, or try --indirect"));
  auto half = two_walls(scattering(kGrey), 0.5f);
  half->lights[0].position = {4, 0, 20}, half->lights[0].intensity = {900, 900, 900};
  add_quad(half.get(), {-9, -9, 12}, {2, -9, 12}, {2, 9, 12}, {-9, 9, 12}, 1);
  CHECK(explanation(half.get()).empty());
  auto inside = two_walls(scattering(kGrey), 0.5f);
  add_box(inside.get(), {-1, -1, 7}, {1, 1, 9}, 1);
  inside->lights[0].position = {0, 0, 20};
  CHECK(has(explanation(inside.get()), "it may be inside an object"));
}

// Goal: a picture without light says so. Method: --effects without lights, and lights without intensity.
TEST_CASE("black_without_light_says_what_is_off") {
  auto s = two_walls(scattering(kGrey), 0.5f);
  CHECK(has(explanation(s.get(), {}, bit(Effect::point_light)), "there is no light: --effects has switched it off"));
  s->lights[0].intensity = kNothing;
  CHECK(has(explanation(s.get()), "there is no light: the scene's lights are at 0"));
}

// Goal: what is behind glass counts, not the glass. Method: a pane before black background and before a black wall.
TEST_CASE("black_behind_glass_is_not_of_the_glass") {
  Material glass = scattering(kNothing);
  glass.transmission = {1, 1, 1}, glass.thin = 1;
  auto pane = two_walls(glass, 0.9f);
  CHECK(explanation(pane.get()).empty());
  auto wall = two_walls(scattering(kNothing), 0.9f);
  const std::uint32_t clear = add_material(wall.get(), glass);
  add_quad(wall.get(), {-4, -3, 1}, {4, -3, 1}, {4, 3, 1}, {-4, 3, 1}, clear);
  CHECK(has(explanation(wall.get()), "material 1 of 3 reflects nothing"));
}

// Goal: no built-in scene is suspected. Method: each, at several sizes, down to a pixel.
TEST_CASE("black_is_not_said_of_built_in_scenes") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i)
    for (std::uint32_t side : {1u, 33u, 120u}) {
      CAPTURE(list[i].name);
      std::vector<std::uint8_t> memory(list[i].need() + kArenaAlignment);
      Arena arena = make_arena("scene", memory.data(), memory.size());
      Scene scene;
      list[i].build(&arena, &scene);
      Settings settings;
      settings.width = side, settings.height = side, settings.threads = 1;
      auto test = make_renderer(scene, settings);
      REQUIRE(render_frame(&test->renderer, 0).ok);
      char text[kBlackTextBytes] = "x";
      CHECK_FALSE(explain_black(test->renderer, {}, text));
      CHECK(text[0] == 0);
    }
}
