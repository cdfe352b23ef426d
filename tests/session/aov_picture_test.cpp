// AOVs as pictures of levels.
#include "session/aov_picture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "base/color.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

struct Colored {
  std::unique_ptr<GeneratedScene> scene = generate_scene(bit(Feature::point_light), 3);
  std::unique_ptr<TestRenderer> test;
  Picture values, colors;
  AovPicture picture;
  Colored(Aov aov, std::uint32_t width, std::uint32_t height, PixelBox box = {}) {
    Settings settings;
    settings.width = width, settings.height = height, settings.threads = 1;
    test = make_renderer(scene->scene, settings);
    Renderer& renderer = test->renderer;
    renderer.view.exposure = 3;
    REQUIRE(render_frame(&renderer, 0, aov).ok);
    values.assign(renderer.image.begin(), renderer.image.end());
    if (box.width == 0) box = {0, 0, static_cast<int>(width), static_cast<int>(height)};
    picture = color_aov(aov, box, &renderer);
    colors.assign(renderer.image.begin(), renderer.image.end());
    CHECK(renderer.view.exposure == 1);
  }
};

Vec3 viridis_at(float place) {
  std::uint8_t levels[3];
  viridis(place, levels);
  return {srgb_to_linear(levels[0]), srgb_to_linear(levels[1]), srgb_to_linear(levels[2])};
}

}  // namespace

// Goal: cost is on the map from 0 to its largest value, which legend and line tell. Method: every pixel.
TEST_CASE("aov_cost_is_on_the_map") {
  Colored c(Aov::cost, 320, 120);
  float most = 0;
  for (const Vec3& v : c.values) most = std::max(most, v.x);
  REQUIRE(most > 10);
  for (std::size_t i = 0; i < c.values.size(); ++i) CHECK(c.colors[i] == viridis_at(c.values[i].x / most));
  const std::string number = std::to_string(static_cast<int>(most));
  CHECK(std::string(c.picture.legend.text).find(number + " boxes") != std::string::npos);
  CHECK(std::string(c.picture.told).find("yellow " + number + " boxes") != std::string::npos);
}

// Goal: a triangle has one colour, and others have others; nothing is black. Method: pixels of the same and of
// different triangles; no legend in a low picture.
TEST_CASE("aov_triangle_has_a_color") {
  Colored c(Aov::triangle, 64, 20);
  CHECK(c.picture.legend.text[0] == 0);
  std::size_t compared = 0;
  for (std::size_t i = 1; i < c.values.size(); ++i) {
    CHECK((c.values[i].x == 0) == is_zero(c.colors[i]));
    CHECK((c.values[i].x == c.values[i - 1].x) == (c.colors[i] == c.colors[i - 1]));
    compared += c.values[i].x != c.values[i - 1].x;
  }
  CHECK(compared > 20);
}

// Goal: of a crop, only its own pixels count and change. Method: the largest cost inside; values outside.
TEST_CASE("aov_of_a_crop_is_its_own") {
  const PixelBox box = {8, 4, 5, 3};
  Colored c(Aov::cost, 32, 24, box);
  float most = 0;
  auto is_inside = [&](std::size_t i) { return i % 32 >= 8 && i % 32 < 13 && i / 32 >= 4 && i / 32 < 7; };
  for (std::size_t i = 0; i < c.values.size(); ++i)
    if (is_inside(i)) most = std::max(most, c.values[i].x);
  for (std::size_t i = 0; i < c.values.size(); ++i)
    CHECK(c.colors[i] == (is_inside(i) ? viridis_at(c.values[i].x / most) : c.values[i]));
}
