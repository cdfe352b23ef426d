// Contrast that goes unseen in what moves.
#include "shade/motion_contrast.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "engine/last_picture.h"
#include "engine/prepare.h"
#include "scene/builtin_helpers.h"
#include "shade/cell.h"
#include "shade_helpers.h"

using namespace pocketray;

namespace {

Settings moving_settings(MovingContrast moving, float contrast = 0.125f) {
  Settings settings;
  settings.width = 64, settings.height = 48, settings.cut_off_levels = 0, settings.light_tolerance = 0;
  settings.selective_contrast = contrast, settings.moving_contrast = moving;
  return settings;
}

constexpr std::uint32_t kStrips = 40;

// A sheet in strips, with pools of light, seen by a camera that can pan.
std::unique_ptr<GeneratedScene> waves() {
  auto s = std::make_unique<GeneratedScene>();
  const std::uint32_t sheet = add_material(s.get(), matte(0.5f));
  for (std::uint32_t i = 0; i < kStrips; ++i) {
    const float x = -10 + 0.5f * static_cast<float>(i);
    add_quad(s.get(), {x, -9, 0}, {x + 0.5f, -9, 0}, {x + 0.5f, 9, 0}, {x, 9, 0}, sheet);
  }
  for (int i = 0; i < 14; ++i) {
    Light light = {};
    light.kind = LightKind::point;
    light.position = {static_cast<float>(i % 7 - 3), i < 7 ? -1.0f : 1.0f, 0.5f};
    light.intensity = {0.3f, 0.3f, 0.3f};
    s->lights.push_back(light);
  }
  aim(s.get(), {0, 0, 6}, {0, 0, 0}, 40);
  s->bind();
  return s;
}

// The second of two frames between which the camera panned; its camera rays.
Picture panned(const Scene& scene, const Settings& settings, float pan, std::uint64_t* rays = nullptr) {
  auto test = make_renderer(scene, settings);
  Renderer* renderer = &test->renderer;
  Camera camera = renderer->camera;
  camera.eye.x -= pan, camera.target.x -= pan;
  REQUIRE(set_camera(renderer, camera).ok);
  REQUIRE(render_frame(renderer, 0).ok);
  camera.eye.x += pan, camera.target.x += pan;
  REQUIRE(set_camera(renderer, camera).ok);
  REQUIRE(render_frame(renderer, 0).ok);
  if (rays) *rays = total_counts(*renderer).rays[static_cast<int>(RayKind::shadow)];
  return Picture(renderer->image.begin(), renderer->image.end());
}

}  // namespace

// Goal: speeds on the retina are Daly's: the eye follows at .82 of the speed, up to 80 degrees a second, and drifts at
// .15. Method: closed form.
TEST_CASE("motion_contrast_follows_with_the_eye") {
  CHECK(retinal_speed(0) == 0.15);
  CHECK(retinal_speed(1) == 0.15);
  CHECK(retinal_speed(10) == doctest::Approx(10 - 8.35));
  CHECK(retinal_speed(50) == doctest::Approx(50 - 41.15));
  CHECK(retinal_speed(200) == doctest::Approx(120));
  for (double speed = 0; speed < 200; speed += 0.5) CHECK(retinal_speed(speed + 0.5) >= retinal_speed(speed));
}

// Goal: sensitivity is Kelly's formula with Daly's constants. Method: against the standard library's logarithm, and by
// what is known of it: about 200 to 300 at most, for one to two cycles per degree that drift by some tenths of a degree
// a second, and hardly any for fine detail at 30 degrees a second.
TEST_CASE("motion_contrast_sensitivity_is_kellys") {
  double most = 0, most_frequency = 0;
  for (double frequency : {0.5, 1.0, 2.0, 3.0, 6.0, 12.0})
    for (double speed : {0.15, 0.5, 1.65, 3.0, 8.0, 30.0}) {
      const double k = 6.1 + 7.3 * std::pow(std::fabs(std::log10(1.7 * speed / 3)), 3);
      const double x = 2 * 3.14159265358979 * frequency * 0.67;
      const double expected = k * 1.14 * 1.7 * speed * x * x * std::exp(-2 * x * (1.7 * speed + 2) / 45.9);
      CHECK(contrast_sensitivity(frequency, speed) == doctest::Approx(expected).epsilon(1e-9));
      if (expected > most) most = expected, most_frequency = frequency;
    }
  CHECK(most > 200);
  CHECK(most < 350);
  CHECK((most_frequency >= 1 && most_frequency <= 3));
  CHECK(contrast_sensitivity(12, 30) < 1e-3);
}

// Goal: the threshold grows with speed, from that at rest to the most that is given up. Method: the ratio of
// sensitivities at the cell's frequency, at several densities and rates; a frame rate twice as high counts the same as
// a density half as high.
TEST_CASE("motion_contrast_threshold_grows_with_speed") {
  for (double density : {12.0, 23.6, 60.0}) {
    MotionTolerance tolerance, twice;
    set_motion_tolerance(density, 30, &tolerance);
    set_motion_tolerance(density, 60, &twice);
    CHECK(tolerance.at[0] == 1);
    for (std::uint32_t step = 0; step <= kMotionStepMax; ++step) {
      const double frequency = density / 8, speed = retinal_speed(step * 30 / density);
      const double ratio = contrast_sensitivity(frequency, 0.15) / contrast_sensitivity(frequency, speed);
      CHECK(static_cast<double>(tolerance.at[step]) ==
            doctest::Approx(std::min(std::max(ratio, 1.0), 4.0)).epsilon(1e-5));
      if (step > 0) CHECK(tolerance.at[step] >= tolerance.at[step - 1]);
      if (2 * step <= kMotionStepMax) CHECK(twice.at[step] == tolerance.at[2 * step]);
    }
    CHECK(tolerance.at[kMotionStepMax] > 1);
  }
}

// Goal: a resting or slow frame is as without the setting, a fast one traces less, and differs. Method: differential,
// bit for bit, and shadow rays counted, over pans of no, one, and many pixels (20 pixels are 25 degrees a second).
TEST_CASE("motion_contrast_changes_what_moves_fast_alone") {
  auto scene = waves();
  const double pixels = 24 / std::tan(radians(20.0)) / 6;  // per unit
  const Settings off = moving_settings(MovingContrast::as_resting), on = moving_settings(MovingContrast::as_seen);
  for (double pan : {0.0, 1.0, 8.0})
    CHECK(same_picture(panned(scene->scene, on, static_cast<float>(pan / pixels)),
                       panned(scene->scene, off, static_cast<float>(pan / pixels))));
  std::uint64_t rays_off, rays_on;
  const Picture fast = panned(scene->scene, on, static_cast<float>(20 / pixels), &rays_on);
  CHECK(!same_picture(fast, panned(scene->scene, off, static_cast<float>(20 / pixels), &rays_off)));
  CHECK(rays_on < rays_off);
}

// Goal: a cell that something at rest takes part in is seen as at rest. Method: the left half of a sheet moves
// fast, the right half rests and is as without the setting.
TEST_CASE("motion_contrast_is_that_of_the_slowest_corner") {
  auto scene = waves();
  auto test = make_renderer(scene->scene, moving_settings(MovingContrast::as_seen));
  Renderer* renderer = &test->renderer;
  REQUIRE(render_frame(renderer, 0).ok);
  // The left half of what the last picture saw was elsewhere.
  std::vector<Vec3> then(renderer->frame.positions.begin(), renderer->frame.positions.end());
  REQUIRE(then.size() == 4 * kStrips);
  for (std::size_t i = 0; i < then.size() / 2; ++i) then[i].y -= 3;
  REQUIRE(prepare_frame(renderer, 0).ok);
  follow_picture(renderer);
  LastPicture last = *renderer->frame.last;
  REQUIRE(last.is_known);
  last.positions = {then.data(), static_cast<std::uint32_t>(then.size())};
  renderer->frame.last = &last;
  Picture picture(renderer->image.count, Vec3{-1, -1, -1});
  trace_spans(&renderer->tracers[0], renderer->spans.data, static_cast<std::uint32_t>(renderer->spans.count), Aov::none,
              picture.data());
  const Picture at_rest = render_picture(scene->scene, moving_settings(MovingContrast::as_resting));
  std::uint32_t differing = 0;
  for (std::uint32_t y = 0; y < 48; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) {
      const bool same = std::memcmp(&picture[y * 64 + x], &at_rest[y * 64 + x], sizeof(Vec3)) == 0;
      if (x >= 28) CHECK(same);  // the cell from column 28 on has corners in column 32, at rest
      differing += !same;
    }
  CHECK(differing > 0);
}

// Goal: fast frames do not depend on threads, and a first frame is as without the setting. Method: differential.
TEST_CASE("motion_contrast_is_independent_of_threads") {
  auto generated = generate_scene(kAllFeatures, 3);
  Settings settings = moving_settings(MovingContrast::as_seen), off = moving_settings(MovingContrast::as_resting);
  CHECK(same_picture(render_picture(generated->scene, settings, 0.4), render_picture(generated->scene, off, 0.4)));
  const Picture expected = panned(generated->scene, settings, 2);
  CHECK(!same_picture(expected, panned(generated->scene, off, 2)));
  for (std::uint32_t threads : {2u, 5u}) {
    settings.threads = threads;
    CHECK(same_picture(panned(generated->scene, settings, 2), expected));
  }
}

// Goal: interleaved frames of what rests are exact even after fast ones. Method: a pan, then rest, against the full
// frame of what rests.
TEST_CASE("motion_contrast_is_forgotten_at_rest") {
  auto scene = waves();
  Settings settings = moving_settings(MovingContrast::as_seen), full = moving_settings(MovingContrast::as_resting);
  settings.resolution = Resolution::interleaved;
  auto test = make_renderer(scene->scene, settings);
  Renderer* renderer = &test->renderer;
  const Camera home = renderer->camera;
  Camera camera = home;
  camera.eye.x -= 2, camera.target.x -= 2;
  REQUIRE(set_camera(renderer, camera).ok);
  REQUIRE(render_frame(renderer, 0).ok);
  REQUIRE(set_camera(renderer, home).ok);
  for (bool rests : {false, false, true}) {
    REQUIRE(render_frame(renderer, 0).ok);
    CHECK(renderer->frame.last->rests == rests);
  }
  CHECK(same_picture(Picture(renderer->image.begin(), renderer->image.end()), render_picture(scene->scene, full)));
}

// Goal: memory planned without it is told. Method: change the settings.
TEST_CASE("motion_contrast_is_refused_without_memory") {
  auto scene = waves();
  auto test = make_renderer(scene->scene, moving_settings(MovingContrast::as_resting));
  CHECK_FALSE(test->renderer.last_picture.is_planned);
  const Status refused = change_settings(&test->renderer, moving_settings(MovingContrast::as_seen));
  CHECK_FALSE(refused.ok);
  CHECK(std::strstr(refused.message, "--moving-contrast as-seen") != nullptr);
}
