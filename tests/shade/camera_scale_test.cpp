#include <doctest/doctest.h>

#include <limits>

#include "base/limits.h"
#include "shade/camera.h"
#include "shade/shade_helpers.h"
#include "support/hard_case.h"
#include "support/scaled_scene.h"

using namespace pocketray;

namespace {

Status rays_of(const Camera& camera, std::uint32_t width, std::uint32_t height, CameraRays* rays) {
  return make_camera_rays(camera, width, height, rays);
}

}  // namespace

// Goal: impossible cameras are refused, and extreme ones give finite unit rays. Method: the degenerate cases by name.
TEST_CASE("hard_28_degenerate_cameras") {
  count_assertions("defined or refused, no NaN");
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  CameraRays rays;
  Camera camera;
  CHECK(rays_of(camera, 1, 1, &rays).ok);
  Ray ray = camera_ray(rays, 0.5f, 0.5f);
  CHECK(ray.direction == Vec3{0, 0, -1});
  Camera same = camera;
  same.target = same.eye;
  CHECK_FALSE(rays_of(same, 4, 3, &rays).ok);
  for (Vec3 up : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{0, 0, 0}, Vec3{0, 0, 1e-30f}, Vec3{0, kCoordinateMax, 0}}) {
    camera.up = up;
    REQUIRE(rays_of(camera, 4, 3, &rays).ok);
    CHECK(dot(rays.right, rays.up) == doctest::Approx(0));
    CHECK(dot(rays.right, rays.forward) == doctest::Approx(0));
    CHECK(length(rays.up) > 0.1f);
    CHECK(is_finite(camera_ray(rays, 0, 0).direction));
  }
  camera = Camera();
  for (float fov : {0.0f, -1.0f, 1e-9f, 3.14159265f, 3.2f, nan, inf}) {
    camera.vertical_fov = fov;
    CHECK_FALSE(rays_of(camera, 4, 3, &rays).ok);
  }
  for (float fov : {2e-5f, 3.12f}) {
    camera.vertical_fov = fov;
    REQUIRE(rays_of(camera, 320, 240, &rays).ok);
    CHECK(length(camera_ray(rays, 0, 0).direction) == doctest::Approx(1));
  }
  camera = Camera();
  for (float extent : {0.0f, -1.0f, nan, inf}) {
    camera.projection = Projection::orthographic;
    camera.vertical_extent = extent;
    CHECK_FALSE(rays_of(camera, 4, 3, &rays).ok);
  }
  camera = Camera();
  camera.eye.x = nan;
  CHECK_FALSE(rays_of(camera, 4, 3, &rays).ok);
}

// Goal: rays go through pixel centres, row 0 on top, and span the field of view. Method: closed form at edges and
// centres.
TEST_CASE("camera_rays_closed_forms") {
  Camera camera;
  camera.vertical_fov = static_cast<float>(kPiD / 2);
  CameraRays rays;
  REQUIRE(rays_of(camera, 4, 2, &rays).ok);
  Vec3 top_left = camera_ray(rays, 0, 0).direction;
  CHECK(top_left.x / -top_left.z == doctest::Approx(-2));
  CHECK(top_left.y / -top_left.z == doctest::Approx(1));
  camera.projection = Projection::orthographic;
  camera.vertical_extent = 6;
  REQUIRE(rays_of(camera, 4, 2, &rays).ok);
  CHECK(camera_ray(rays, 4, 2).origin.x == doctest::Approx(6));
  CHECK(camera_ray(rays, 4, 2).origin.y == doctest::Approx(-3));
}

// Goal: no absolute epsilon anywhere: the scene × 2^±20 gives the same picture, bit for bit. Method: differential with
// every feature; all lengths are scaled, radiance is not.
TEST_CASE("hard_29_scene_scaled_by_powers_of_two_same_image") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Settings settings = settings_for(kAllFeatures, effort_side(48), effort_side(36));
    auto source = generate_scene(kAllFeatures, seed);
    Picture expected = render_picture(source->scene, settings, 0.5);
    for (float k : {0x1p20f, 0x1p-20f, 0x1p7f}) {
      auto scaled = scale_scene(source->scene, k);
      bool same = same_picture(render_picture(scaled->scene, settings, 0.5), expected);
      CAPTURE(k);
      CHECK(same);
      count_hard(expected.size(), same ? 0 : expected.size(), "every pixel the same bits");
    }
  }
}

// Goal: normals of any length, missing and opposite ones leave no NaN in a picture, and zero normals give the picture
// of a scene without normals. Method: sweep of what a file might hold in a normal; differential.
TEST_CASE("hard_30_strange_normals_give_finite_pictures") {
  count_assertions("finite; without length as without normals");
  Settings settings = settings_for(kAllFeatures, 24, 18), flat = settings;
  flat.normals = NormalMode::flat;
  for (float size : {0.0f, 1e-30f, 1e30f, -1.0f, 1.0000002f}) {
    auto s = generate_scene(kAllFeatures, 2);
    for (std::size_t i = 0; i < s->normals.size(); ++i) s->normals[i] = (i % 3 ? s->normals[i] : Vec3{0, 1, 0}) * size;
    s->rest_normals.assign(s->rest_normals.size(), Vec3{0, size, 0});
    s->bind();
    CAPTURE(size);
    Picture picture = render_picture(s->scene, settings, 0.5);
    bool finite = true;
    for (const Vec3& p : picture) finite &= is_finite(p) && p.x >= 0;
    CHECK(finite);
    CHECK(same_picture(picture, render_picture(s->scene, flat, 0.5)) == (size == 0));
  }
}
