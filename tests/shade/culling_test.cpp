// One-sided surfaces.
#include <doctest/doctest.h>

#include "support/generated_scene.h"

using namespace pocketray;

// Goal: glTF's one-sided materials are invisible from behind, and only there. Method: a quad between the camera and a
// wall, seen from both sides; the colour of the centre pixel tells which of the two is visible.
TEST_CASE("back_face_culling_shows_what_is_behind_the_back_of_a_one_sided_surface") {
  for (bool double_sided : {false, true}) {
    for (bool from_front : {false, true}) {
      GeneratedScene g;
      Material near, far;
      near.unlit = far.unlit = 1;
      near.diffuse = {1, 0, 0};
      far.diffuse = {0, 0, 1};
      near.double_sided = double_sided;
      g.materials = {near, far};
      g.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-9, -9, -1}, {9, -9, -1}, {0, 9, -1}};
      std::uint32_t second = from_front ? 1 : 2, third = from_front ? 2 : 1;
      g.triangles = {{0, second, third, 0}, {3, 4, 5, 1}};
      Camera camera;
      camera.eye = {0, 0, 3};
      camera.target = {0, 0, 0};
      g.cameras = {camera};
      g.bind();
      Settings settings;
      settings.width = settings.height = 1;
      auto test = make_renderer(g.scene, settings);
      REQUIRE(render_frame(&test->renderer, 0).ok);
      CAPTURE(double_sided);
      CAPTURE(from_front);
      Vec3 expected = double_sided || from_front ? near.diffuse : far.diffuse;
      CHECK(test->renderer.image[0] == expected);
      CHECK(has(test->renderer.effects.mask, Effect::back_face_culling) == !double_sided);
      REQUIRE(render_frame(&test->renderer, 0, Aov::depth).ok);
      CHECK(test->renderer.image[0].x == doctest::Approx(double_sided || from_front ? 3 : 4));
    }
  }
}

// Goal: of two one-sided surfaces back to back, each shows its own front, whichever comes first in the list. Method: a
// ray from either side, colour and depth.
TEST_CASE("back_face_culling_shows_the_front_of_surfaces_back_to_back") {
  for (bool swapped : {false, true}) {
    for (float side : {1.0f, -1.0f}) {
      GeneratedScene g;
      Material up, down;
      up.unlit = down.unlit = 1;
      up.double_sided = down.double_sided = 0;
      up.diffuse = {1, 0, 0};
      down.diffuse = {0, 0, 1};
      g.materials = {up, down};
      g.positions = {{-1, -1, 0.5f}, {1, -1, 0.5f}, {0, 1, 0.5f}};
      g.triangles = {{0, 1, 2, 0}, {0, 2, 1, 1}};
      if (swapped) std::swap(g.triangles[0], g.triangles[1]);
      aim(&g, {0.1f, 0, 0.5f + 3 * side}, {0.1f, 0, 0.5f}, 40);
      g.bind();
      Settings settings;
      settings.width = settings.height = 1;
      auto test = make_renderer(g.scene, settings);
      REQUIRE(render_frame(&test->renderer, 0).ok);
      CAPTURE(swapped);
      CAPTURE(side);
      CHECK(test->renderer.image[0] == (side > 0 ? up.diffuse : down.diffuse));
      REQUIRE(render_frame(&test->renderer, 0, Aov::depth).ok);
      CHECK(test->renderer.image[0].x == doctest::Approx(3));
    }
  }
}
