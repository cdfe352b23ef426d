// Near planes of cameras.
#include <doctest/doctest.h>

#include "shade/camera.h"
#include "shade/shade_helpers.h"
#include "support/divided_picture.h"

using namespace pocketray;

namespace {

// A floor, a box on it, and a camera inside a wall that ends before the near plane.
std::unique_ptr<GeneratedScene> walled_in(Projection projection, bool with_wall) {
  auto s = std::make_unique<GeneratedScene>();
  const std::uint32_t white = add_material(s.get(), matte(0.8f));
  add_quad(s.get(), {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, white);
  add_box(s.get(), {-0.5f, 0, -1}, {0.4f, 1.1f, 0.2f}, white);
  if (with_wall) add_box(s.get(), {-8, -1, 3.5f}, {8, 4, 4.2f}, white);
  Camera camera;
  camera.eye = {0.5f, 1, 4}, camera.target = {0.2f, 0.6f, 0}, camera.projection = projection;
  camera.vertical_extent = 3;
  s->cameras = {camera};
  s->lights.resize(1);
  s->lights[0].position = {2, 3, 2};
  s->bind();
  return s;
}

std::vector<Vec3> picture(TestRenderer* t) {
  REQUIRE(render_frame(&t->renderer, 0).ok);
  return {t->renderer.image.begin(), t->renderer.image.end()};
}

}  // namespace

// Goal: a camera in a wall sees past it, as if the wall were cut open before the near plane; without a near plane, it
// sees the wall's inside. Method: the nearest surfaces against those of the scene without the wall, whose perspective
// camera needs no near plane and traces packets; the shadow of the wall is not asked for. Depths are those from the
// eye.
TEST_CASE("near_plane_shows_what_lies_beyond") {
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    auto walled = walled_in(projection, true), open = walled_in(projection, false);
    const float near_distance = 1;
    Settings settings = settings_for(0, 24, 16);
    settings.forced_off = bit(Effect::shadow);
    walled->scene.camera_near = open->scene.camera_near = {&near_distance, 1};
    auto t = make_renderer(walled->scene, settings), without = make_renderer(open->scene, settings);
    const std::vector<Vec3> a = picture(t.get()), b = picture(without.get());
    CHECK(t->renderer.frame.view.camera.near_distance == 1);
    CHECK_FALSE(t->renderer.frame.view.camera.has_one_origin);
    // The orthographic camera's rays begin below the floor, too.
    CHECK(without->renderer.frame.view.camera.has_one_origin == (projection == Projection::perspective));
    for (std::size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c) CHECK(a[i][c] == doctest::Approx(b[i][c]).epsilon(1e-4));
    for (Aov aov : {Aov::depth, Aov::triangle}) {
      const Span row = {9, 0, 24};
      for (TestRenderer* renderer : {t.get(), without.get()}) {
        Tracer tracer = make_tracer(renderer->renderer.frame);
        trace_spans(&tracer, &row, 1, aov, renderer->renderer.image.data);
      }
      for (std::size_t i = 9 * 24; i < 10 * 24; ++i)
        CHECK(t->renderer.image[i].x == doctest::Approx(without->renderer.image[i].x).epsilon(1e-5));
    }
    walled->scene.camera_near = {};
    auto inside = make_renderer(walled->scene, settings);
    CHECK(picture(inside.get()) != a);
  }
}

// Goal: the near plane has no say where nothing lies before it, nor for a camera that is not the scene's.
TEST_CASE("near_plane_is_left_out_without_need") {
  auto s = walled_in(Projection::perspective, true);
  CameraRays rays;
  REQUIRE(make_camera_rays(s->cameras[0], 32, 24, &rays).ok);
  auto is_set = [&](float distance) {
    set_near_plane(distance, s->scene.positions, s->scene.triangles, &rays);
    CHECK(rays.has_one_origin == (rays.near_distance == 0));
    return rays.near_distance > 0;
  };
  CHECK_FALSE(is_set(0));
  CHECK_FALSE(is_set(0.3f));  // the wall's face is .5 away
  CHECK(is_set(0.7f));
  CHECK(rays.near_distance == 0.7f);
  const float near_distance = 1;
  s->scene.camera_near = {&near_distance, 1};
  auto t = make_renderer(s->scene, settings_for(0, 8, 8));
  picture(t.get());
  CHECK(t->renderer.frame.view.camera.near_distance == 1);
  REQUIRE(set_camera(&t->renderer, s->cameras[0]).ok);
  picture(t.get());
  CHECK(t->renderer.frame.view.camera.near_distance == 0);
}

// Goal: pictures before which something is cut away do not depend on how they are divided, with every method that
// traces several camera rays together.
TEST_CASE("near_plane_does_not_depend_on_how_a_picture_is_divided") {
  auto s = walled_in(Projection::perspective, true);
  const float near_distance = 1;
  s->scene.camera_near = {&near_distance, 1};
  for (int variant = 0; variant < 3; ++variant) {
    Settings settings = settings_for(0, 40, 28);
    if (variant == 1) settings.selective_contrast = 0.05f;
    if (variant == 2) settings.samples_per_pixel = 2;
    auto t = make_renderer(s->scene, settings);
    const std::vector<Vec3> whole = picture(t.get());
    const Divisions by(settings.height);
    CAPTURE(variant);
    CHECK(different_pixels(t->renderer, whole, by.rows, 8) == 0);
    CHECK(different_pixels(t->renderer, whole, by.pixels, 7) == 0);
  }
}
