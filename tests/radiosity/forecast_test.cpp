// The cost of a solution, predicted.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

#include "radiosity/loose.h"
#include "scene/builtin_helpers.h"

using namespace pocketray;

namespace {

RadiosityOptions options_with(std::uint32_t patches) {
  RadiosityOptions options;
  options.patch_count = patches, options.threads = 2;
  return options;
}

double solve_seconds(const FrameData& frame, const RadiosityOptions& options, RadiositySolution* solution) {
  const auto start = std::chrono::steady_clock::now();
  REQUIRE(solve_radiosity(
              frame, options, [](double) { return true; }, solution)
              .ok);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A floor of one-sided triangles under a lamp, and a double-sided sheet between them.
Loose sheet_over_floor() {
  Loose loose;
  loose.materials.resize(1);
  loose.materials[0].diffuse = {.6f, .6f, .6f}, loose.materials[0].double_sided = 1;
  loose.lights.resize(1);
  loose.lights[0].kind = LightKind::point, loose.lights[0].position = {0, 3, 0}, loose.lights[0].intensity = {9, 9, 9};
  loose.add({-2, 0, -2}, {-2, 0, 2}, {2, 0, 2});
  loose.add({-2, 0, -2}, {2, 0, 2}, {2, 0, -2});
  loose.add({-1, 1, -1}, {-1, 1, 1}, {1, 1, 1});
  loose.add({-1, 1, -1}, {1, 1, 1}, {1, 1, -1});
  return loose;
}

}  // namespace

// Goal: the forecast's bytes and patches are the solution's. Method: a built-in scene and a sheet that is lit from both
// sides, with few patches and with more; the bytes of fronts are fewer where backs store light, and all where none
// does.
TEST_CASE("forecast_knows_the_bytes_of_a_solution") {
  Loose sheet = sheet_over_floor();
  auto cube = build_builtin("cube");
  for (const Scene* scene : {&sheet.bind(), static_cast<const Scene*>(&cube->scene)})
    for (std::uint32_t patches : {40u, 160u}) {
      CAPTURE(patches);
      auto test = solving_renderer(*scene);
      RadiosityForecast forecast;
      REQUIRE(forecast_radiosity(test->renderer.frame, options_with(patches), &forecast).ok);
      RadiositySolution solution;
      solve_seconds(test->renderer.frame, options_with(patches), &solution);
      CHECK(forecast.size.bytes == solution.bytes());
      CHECK(forecast.size.patch_count == solution.patch_count);
      CHECK(forecast.seconds > 0);
      const std::size_t fronts = radiosity_bytes_of_fronts(*scene, options_with(patches));
      CHECK(fronts <= solution.bytes());
      CHECK((fronts == solution.bytes()) == (scene != &sheet.scene));
      CHECK(fronts > solution.bytes() / 2);
    }
}

// Goal: the predicted time is the solver's within a factor of two, for less work. Method: `cube` by 600 patches; since
// other programs may slow either measurement, the best of five.
TEST_CASE("forecast_knows_the_time_of_a_solution") {
  auto built = build_builtin("cube");
  auto test = solving_renderer(built->scene);
  double best = 0, share = 1;
  for (int attempt = 0; attempt < 5 && best < 0.5; ++attempt) {
    RadiosityForecast forecast;
    const auto start = std::chrono::steady_clock::now();
    REQUIRE(forecast_radiosity(test->renderer.frame, options_with(600), &forecast).ok);
    const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    RadiositySolution solution;
    const double seconds = solve_seconds(test->renderer.frame, options_with(600), &solution);
    best = std::max(best, std::min(forecast.seconds / seconds, seconds / forecast.seconds));
    share = std::min(share, taken / seconds);
  }
  CHECK(best >= 0.5);
  CHECK(share < 0.8);
}

// Goal: nothing to divide is refused as by the solver. Method: a triangle without area.
TEST_CASE("forecast_refuses_what_the_solver_refuses") {
  Loose nothing;
  nothing.materials.resize(1);
  nothing.lights.resize(1);
  nothing.add({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  auto test = solving_renderer(nothing.bind());
  RadiosityForecast forecast;
  CHECK_FALSE(forecast_radiosity(test->renderer.frame, options_with(10), &forecast).ok);
  CHECK(radiosity_bytes_of_fronts(nothing.scene, options_with(10)) == 0);
}
