// Pixels carried over from the last picture: where they were, and what is taken of them.
#include "shade/carried.h"

#include <doctest/doctest.h>

#include <cmath>

#include "scene/builtin_helpers.h"
#include "shade/camera.h"
#include "shade_helpers.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 48, kHeight = 36;

CameraRays camera_at(const Vec3& eye, const Vec3& target, double degrees, bool orthographic = false) {
  Camera camera;
  camera.eye = eye, camera.target = target, camera.vertical_fov = static_cast<float>(radians(degrees));
  if (orthographic) camera.projection = Projection::orthographic, camera.vertical_extent = 4;
  CameraRays rays;
  REQUIRE(make_camera_rays(camera, kWidth, kHeight, &rays).ok);
  return rays;
}

// One triangle, and the frames in which a camera and the triangle moved.
struct Moved {
  Vec3 was[3], is[3];
  Triangle triangle = {};
  Scene scene;
  FrameData frame;
  LastPicture last;

  Moved(const Vec3 (&then)[3], const Vec3 (&now)[3], const CameraRays& camera_then, const CameraRays& camera_now) {
    for (std::uint32_t i = 0; i < 3; ++i) was[i] = then[i], is[i] = now[i];
    GeneratedScene s;
    add_triangle(&s, 0, 1, 2, 0);
    triangle = s.triangles[0];
    scene.triangles = {&triangle, 1};
    frame.scene = &scene, frame.positions = {is, 3}, frame.camera = camera_now;
    last.positions = {was, 3}, last.camera = camera_then, last.is_known = true;
  }
};

constexpr Vec3 kWall[3] = {{-9, -9, 0}, {18, -9, 0}, {-9, 18, 0}};  // (0, 0, 0) is at u = v = 1/3

Hit hit_at(float u, float v, float t) { return {t, u, v, 0}; }

}  // namespace

// Goal: every pixel's ray leads back to the pixel. Method: points along the rays of both projections; none behind them.
TEST_CASE("carried_place_inverts_the_camera_ray") {
  for (bool orthographic : {false, true}) {
    const CameraRays camera = camera_at({1, 2, 5}, {0.5f, 0.25f, -1}, 50, orthographic);
    for (std::uint32_t y = 0; y < kHeight; y += 5)
      for (std::uint32_t x = 0; x < kWidth; x += 7) {
        const float column = static_cast<float>(x) + 0.25f, row = static_cast<float>(y) + 0.5f;
        const Ray ray = camera_ray(camera, column, row);
        Vec2 place;
        REQUIRE(place_in_picture(camera, ray.origin + ray.direction * 3.5f, &place));
        CHECK(place.x == doctest::Approx(column).epsilon(1e-4));
        CHECK(place.y == doctest::Approx(row).epsilon(1e-4));
        if (!orthographic) CHECK_FALSE(place_in_picture(camera, ray.origin - ray.direction, &place));
      }
  }
}

// Goal: how far a surface has moved across the picture is as geometry says. Method: closed forms, for a camera that
// steps sideways by d at distance z (d · height / (2 z tan(fov/2)) pixels), a triangle that does, and a camera that
// turns by an angle before the background: tan(angle) in place of d / z, at the picture's middle.
TEST_CASE("carried_steps_are_those_of_closed_forms") {
  constexpr double kDegrees = 40, kDistance = 6;
  const double pixels = 0.5 * kHeight / std::tan(radians(kDegrees / 2));  // at distance 1
  const CameraRays middle = camera_at({0, 0, 6}, {0, 0, 0}, kDegrees);
  const std::uint32_t column = kWidth / 2, row = kHeight / 2;  // its centre is half a pixel right of and below (0, 0)
  const float aside = static_cast<float>(0.5 / pixels * kDistance);
  const float third = 1.0f / 3, step_u = aside / 27, step_v = -aside / 27;
  const Hit hit = hit_at(third + step_u, third + step_v, 6);
  Vec2 step;
  for (double d : {0.05, 0.4}) {
    const auto shift = static_cast<float>(d);
    const CameraRays left = camera_at({-shift, 0, 6}, {-shift, 0, 0}, kDegrees);
    Moved camera_moved(kWall, kWall, left, middle);
    REQUIRE(step_to_last(camera_moved.frame, camera_moved.last, column, row, hit, &step));
    CHECK(static_cast<double>(step.x) == doctest::Approx(d / kDistance * pixels).epsilon(1e-3));
    CHECK(std::fabs(static_cast<double>(step.y)) < 1e-3);
    Vec3 there[3];
    for (int i = 0; i < 3; ++i) there[i] = kWall[i] + Vec3{0, shift, 0};
    Moved wall_moved(there, kWall, middle, middle);
    REQUIRE(step_to_last(wall_moved.frame, wall_moved.last, column, row, hit, &step));
    CHECK(std::fabs(static_cast<double>(step.x)) < 1e-3);
    CHECK(static_cast<double>(step.y) == doctest::Approx(-d / kDistance * pixels).epsilon(1e-3));
    const auto angle = static_cast<float>(d * 0.5);
    const CameraRays turned = camera_at({0, 0, 6}, {-6 * std::tan(angle), 0, 0}, kDegrees);
    Moved background(kWall, kWall, turned, middle);
    REQUIRE(step_to_last(background.frame, background.last, column, row, Hit{0, 0, 0, kNoTriangle}, &step));
    const double half_pixel = std::atan(0.5 / pixels);
    CHECK(static_cast<double>(step.x) ==
          doctest::Approx(std::tan(static_cast<double>(angle) + half_pixel) * pixels - 0.5).epsilon(1e-3));
  }
}

// Goal: what rests has moved by exactly nothing; what the last camera did not see is told. Method: the same camera and
// triangle; a camera that looked away.
TEST_CASE("carried_steps_are_zero_at_rest") {
  const CameraRays camera = camera_at({0.3f, 0.1f, 6}, {0, 0, 0}, 40), away = camera_at({0, 0, 6}, {0, 0, 12}, 40);
  Moved rests(kWall, kWall, camera, camera), looked_away(kWall, kWall, away, camera);
  for (std::uint32_t i = 0; i < 20; ++i)
    for (std::uint32_t triangle : {0u, kNoTriangle}) {
      Vec2 step = {1, 1};
      const Hit hit = {6, 0.31f, 0.33f, triangle};
      CHECK(step_to_last(rests.frame, rests.last, i, i + 3, hit, &step));
      CHECK((step.x == 0 && step.y == 0));
      CHECK_FALSE(step_to_last(looked_away.frame, looked_away.last, i, i + 3, hit, &step));
    }
}

// Goal: what is carried over lies within the neighbours' range, comes from where the surface was, and gives way to
// what lies between them where they agree, have parted, or where the place was out of the picture. Method: a ramp as
// the last picture, whose values between pixels are known.
TEST_CASE("carried_pixels_are_as_defined") {
  std::vector<Vec3> ramp(kWidth * kHeight);
  auto value_at = [](float x, float y) { return Vec3{x + 100, 2 * y + 100, 50}; };
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x)
      ramp[y * kWidth + x] = value_at(static_cast<float>(x), static_cast<float>(y));
  const CameraRays camera = camera_at({0, 0, 6}, {0, 0, 0}, 40), other = camera_at({1, 0, 6}, {0, 0, 0}, 40);
  LastPicture last;
  last.is_known = true, last.camera = camera, last.pixels = {ramp.data(), kWidth * kHeight};
  const Vec3 low = {0, 0, 0}, high = {300, 300, 300}, between = {7, 8, 9};
  CarryFrom from;
  const std::uint32_t column = 20, row = 11;
  const std::size_t around[4] = {row * kWidth + column - 1, row * kWidth + column + 1, (row - 1) * kWidth + column,
                                 (row + 1) * kWidth + column};
  auto reset = [&] {
    from.knows_steps = true;
    for (int i = 0; i < 4; ++i) from.index[i] = around[i], from.value[i] = i % 2 ? &high : &low, from.step[i] = {0, 0};
  };
  auto pixel = [&](int pair = 0) { return carried(last, camera, column, row, from, pair, between); };
  reset();
  CHECK(pixel() == value_at(20, 11));
  for (Vec2& step : from.step) step = {2.5f, -1.25f};
  CHECK(pixel() == value_at(22.5f, 9.75f));
  from.step[2] = from.step[3] = {1, 3};
  CHECK(pixel(2) == value_at(21, 14));
  from.step[0] = {2, 0}, from.step[1] = {2.5f, 0.25f};  // the mean
  CHECK(pixel() == value_at(22.25f, 11.125f));
  from.step[1] = {3.5f, 0};
  CHECK(pixel() == between);
  from.step[1] = {__builtin_nanf(""), 0};
  CHECK(pixel() == between);
  reset();
  for (Vec2& step : from.step) step = {-30, 0};
  CHECK(pixel() == between);
  for (Vec2& step : from.step) step = {0, 30};
  CHECK(pixel() == between);
  reset();
  const Vec3 dim = {110, 110, 40}, bright = {115, 111, 45};  // alike
  for (int i = 0; i < 4; ++i) from.value[i] = i % 2 ? &bright : &dim, from.step[i] = {1, 1};
  CHECK(pixel() == between);
  from.step[0] = from.step[1] = {0, 0};
  CHECK(pixel() == Vec3{115, 111, 45});  // of (120, 122, 50), within their range
  // Where nothing has changed, out of their range, too: at rest, or with neighbours as they were.
  for (int i = 0; i < 4; ++i) from.value[i] = &ramp[around[i]], from.step[i] = {0, 0};
  ramp[row * kWidth + column] = {900, 1, 1};
  CHECK(pixel() == Vec3{900, 1, 1});
  from.step[3] = {0.5f, 0};
  CHECK(pixel() != Vec3{900, 1, 1});
  last.rests = true;
  CHECK(pixel() == Vec3{900, 1, 1});
  last.rests = false;
  // Steps that are not known: before a camera at rest, and neighbours that are about as they were.
  from.knows_steps = false;
  CHECK(pixel() == Vec3{900, 1, 1});
  from.value[0] = &dim;
  CHECK(pixel() != between);
  from.value[0] = &high;
  CHECK(pixel() == between);
  from.value[0] = &ramp[around[0]], last.camera = other;
  CHECK(pixel() == between);
}

// Goal: the last picture takes memory with the setting alone. Method: closed form, with and without motion.
TEST_CASE("carried_memory_is_planned_with_the_setting") {
  auto moving = generate_scene(kAllFeatures, 1), still = generate_scene(kAllFeatures & ~bit(Feature::animation), 1);
  REQUIRE(is_animated(moving->scene));
  Settings settings;
  settings.threads = 3;
  for (Resolution resolution : {Resolution::full, Resolution::checkerboard, Resolution::half}) {
    settings.resolution = resolution;
    CHECK(last_picture_need(moving->scene, kAllEffects, settings) == 0);
  }
  settings.resolution = Resolution::interleaved;
  const std::size_t least = arena_need<Vec3>(320 * 240) + arena_need<Vec2>(3 * kWindowRows * 320);
  CHECK(last_picture_need(still->scene, kAllEffects, settings) == least);
  CHECK(last_picture_need(moving->scene, kAllEffects, settings) ==
        least + arena_need<Vec3>(moving->scene.positions.count));
  settings.forced_off = bit(Effect::undersampling);
  CHECK(last_picture_need(moving->scene, kAllEffects, settings) == 0);
  settings.moving_contrast = MovingContrast::as_seen;
  CHECK(last_picture_need(moving->scene, kAllEffects, settings) == arena_need<Vec3>(moving->scene.positions.count));
  CHECK(last_picture_need(still->scene, kAllEffects, settings) == 0);
}
