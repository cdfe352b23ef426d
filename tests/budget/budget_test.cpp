// Budgets over real frames, with time computed from the work done.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/frame.h"
#include "plan/governor.h"
#include "scene/builtin/builtin.h"
#include "session/camera_control.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kPointsMax = 4;  // per area light: more would take longer and test nothing else

struct Flight {
  std::unique_ptr<std::uint8_t[]> block;
  Scene scene;
  std::unique_ptr<TestRenderer> test;
  Flight(const char* name, std::uint32_t width, std::uint32_t height) {
    const BuiltinScene* builtin = find_builtin(name);
    std::size_t bytes = builtin->need() + kArenaAlignment;
    block.reset(new std::uint8_t[bytes]);
    Arena arena = make_arena("scene", block.get(), bytes);
    builtin->build(&arena, &scene);
    Settings settings;
    settings.width = width, settings.height = height;
    settings.points_per_area_light = kPointsMax, settings.resolution = Resolution::half;
    test = make_renderer(scene, settings);
  }
};

// Frame time from counted traversal steps, the same on every machine and under every load.
double work_ns(const Renderer& renderer) {
  Tracer t = total_counts(renderer);
  double rays = 0;
  for (std::uint64_t n : t.rays) rays += static_cast<double>(n);
  return 50e3 + 60 * static_cast<double>(renderer.settings.width * renderer.settings.height) + 60 * rays +
         8 * static_cast<double>(t.stats.nodes) + 4 * static_cast<double>(t.stats.triangles);
}

constexpr std::uint32_t kSettlingFrames = 40;

struct FlightResult {
  std::uint32_t late = 0, settle = 0, switches = 0;
  double mean_ns = 0;
};

// The camera orbits its target by 2° per frame while the scene moves.
FlightResult fly(Flight* flight, const Front& front, double budget_ns, std::uint32_t frame_count) {
  Renderer* renderer = &flight->test->renderer;
  CameraControl camera = make_camera_control(flight->scene.cameras[0], renderer->accel.built.bounds);
  Governor g;
  double pixels = static_cast<double>(renderer->settings.width) * renderer->settings.height;
  start_governor(front, budget_ns, pixels, 4, false, &g);
  FlightResult result;
  for (std::uint32_t frame = 0; frame < frame_count; ++frame) {
    const Candidate& c = front.candidates[next_candidate(&g)];
    REQUIRE(change_settings(renderer, with_candidate(renderer->settings, c)).ok);
    REQUIRE(set_camera(renderer, orbited_camera(camera, 2 * static_cast<float>(frame))).ok);
    REQUIRE(render_frame(renderer, frame / 25.0).ok);
    double ns = work_ns(*renderer);
    observe_frame(&g, ns);
    bool late = ns > 1.1 * budget_ns;
    if (frame >= kSettlingFrames)
      result.late += late;
    else if (late)
      result.settle = frame + 1;
    result.mean_ns += ns / frame_count;
  }
  result.switches = g.switch_count;
  return result;
}

// A candidate's frame time at the camera's start.
double frame_ns(Flight* flight, const Candidate& c) {
  Renderer* renderer = &flight->test->renderer;
  REQUIRE(change_settings(renderer, with_candidate(renderer->settings, c)).ok);
  REQUIRE(render_frame(renderer, 0).ok);
  return work_ns(*renderer);
}

}  // namespace

// Goal: once prices are learnt, frames of a flight meet and use their budget. Method: the built-in ladder with its
// guessed prices, frames of real scenes with an orbiting camera, two budgets each between the fastest and the most
// expensive candidate; time is counted work.
TEST_CASE("budget_is_kept_on_a_flight") {
  const std::uint32_t frame_count = static_cast<std::uint32_t>(effort(140));
  for (const char* name : {"cornell", "seesaw"}) {
    Flight flight(name, effort_side(24), effort_side(18));
    Front front, ladder = builtin_front(0);
    for (std::uint32_t i = 0; i < ladder.count; ++i)
      if (ladder.candidates[i].points_per_area_light <= kPointsMax)
        front.candidates[front.count++] = ladder.candidates[i];
    drop_what_scene_ignores(&front, flight.test->renderer.effects.mask | bit(Effect::supersampling));
    double fastest = frame_ns(&flight, front.candidates[0]);
    for (double factor : {3.0, 6.0}) {
      FlightResult result = fly(&flight, front, factor * fastest, frame_count);
      CAPTURE(name);
      CAPTURE(factor);
      if (frame_count <= 2 * kSettlingFrames) continue;  // under instrumentation it is enough that it runs
      double within = 1 - static_cast<double>(result.late) / (frame_count - kSettlingFrames);
      MESSAGE(std::string(name) << ", budget " << factor << " times what the fastest settings take: " << 100 * within
                                << " % of " << frame_count << " frames within 110 %, settled within " << result.settle
                                << " frames, mean " << result.mean_ns / (factor * fastest) << " of the budget, "
                                << result.switches << " switches");
      CHECK(within >= 0.95);
      CHECK(result.mean_ns > 0.15 * factor * fastest);
      CHECK(result.switches <= 40);
    }
  }
}
