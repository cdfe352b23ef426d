// Pictures that show nothing of their model, and why.
#include "session/nothing_picture.h"

#include <doctest/doctest.h>

#include <string>

#include "scene/builtin/builtin.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// A square of side 2 about the origin, seen from z = 8, of one material.
std::unique_ptr<GeneratedScene> square(const Material& material, float side = 2, float depth = 0) {
  auto s = std::make_unique<GeneratedScene>();
  const float h = side / 2;
  add_material(s.get(), material);
  add_quad(s.get(), {-h, -h, depth}, {h, -h, depth}, {h, h, depth}, {-h, h, depth}, 0);
  aim(s.get(), {0, 0, 8}, {0, 0, 0}, 41);
  Light light;
  light.position = {0, 0, 6}, light.intensity = {30, 30, 30};
  s->lights.push_back(light);
  return s;
}

Material grey() {
  Material m;
  m.diffuse = {0.5f, 0.5f, 0.5f};
  return m;
}

std::string explanation(GeneratedScene* s, const std::vector<std::string>& names = {}) {
  s->bind();
  Settings settings;
  settings.width = 64, settings.height = 48, settings.threads = 1;
  auto test = make_renderer(s->scene, settings);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  char text[kBlackTextBytes] = "x";
  const bool is_explained = explain_picture(test->renderer, names, text);
  CHECK(is_explained == (text[0] != 0));
  return text;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

// Goal: each reason for an empty picture is told; a picture with a surface is not suspected. Method: a square that is
// made transparent, culled, flat, and moved.
TEST_CASE("nothing_in_the_picture_is_explained") {
  CHECK(explanation(square(grey()).get()).empty());
  Material clear = grey();
  clear.alpha_mode = AlphaMode::blend, clear.opacity = 0;
  CHECK(
      has(explanation(square(clear).get(), {"Glass"}), "nothing of the model: material 'Glass' is fully transparent"));
  clear.opacity = 0.01f;
  CHECK(explanation(square(clear).get()).empty());
  Material hole = grey();
  hole.alpha_mode = AlphaMode::mask, hole.opacity = 0.25f;
  CHECK(has(explanation(square(hole).get()), "material 1 of 1 is fully transparent"));
  Material one_sided = grey();
  one_sided.double_sided = 0;
  CHECK(explanation(square(one_sided).get()).empty());
  auto behind = square(one_sided);
  aim(behind.get(), {0, 0, -8}, {0, 0, 0}, 41);
  CHECK(has(explanation(behind.get()), "the camera sees the back"));
  CHECK(has(explanation(square(grey(), 2, 12).get()), "behind the camera"));
  CHECK(has(explanation(square(grey(), 0.001f).get()), "smaller than a pixel"));
  CHECK(has(explanation(square(grey(), 0).get()), "no area at this time"));
  auto beside = square(grey());
  aim(beside.get(), {0, 0, 8}, {0, 9, 0}, 41);
  CHECK(has(explanation(beside.get()), "beside the picture"));
}

// Goal: no built-in scene is suspected.
TEST_CASE("nothing_is_not_said_of_built_in_scenes") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(list[i].name);
    std::vector<std::uint8_t> memory(list[i].need() + kArenaAlignment);
    Arena arena = make_arena("scene", memory.data(), memory.size());
    Scene scene;
    list[i].build(&arena, &scene);
    Settings settings;
    settings.width = 33, settings.height = 33, settings.threads = 1;
    auto test = make_renderer(scene, settings);
    REQUIRE(render_frame(&test->renderer, 0).ok);
    char text[kBlackTextBytes] = "x";
    CHECK_FALSE(explain_nothing(test->renderer, {}, text));
    CHECK(text[0] == 0);
  }
}
