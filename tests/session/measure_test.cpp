// What bench measures.
#include "session/measure.h"

#include <doctest/doctest.h>

#include <cstring>

#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

std::unique_ptr<TestRenderer> make_seesaw(CoherenceMode mode) {
  Settings settings;
  settings.width = 32, settings.height = 24;
  settings.coherence = mode;
  return make_renderer(shared_builtin("seesaw")->scene, settings);
}

Measurement measure(Renderer* renderer, std::uint32_t frame_count) {
  Measurement m = make_measurement(*renderer, frame_count);
  Status status = measure_frames(renderer, &m);
  REQUIRE_MESSAGE(status.ok, status.message);
  return m;
}

}  // namespace

// Goal: the frames that coherence traces whole are counted. Method: on, after the first frame none is; while it rests
// for three frames, of which one warms up, two are, and so is the next, which follows none.
TEST_CASE("measure_counts_frames_traced_whole") {
  std::unique_ptr<TestRenderer> renderer = make_seesaw(CoherenceMode::on);
  Measurement m = measure(&renderer->renderer, 4);
  CHECK(m.coherent);
  CHECK(m.whole_frames == 0);
  CHECK(m.whole_because == nullptr);
  CHECK(m.pixels_traced < 4 * 32 * 24 / 2);
  renderer = make_seesaw(CoherenceMode::automatic);
  renderer->renderer.history.state.trial.rest = 3;
  m = measure(&renderer->renderer, 2);
  CHECK(m.whole_frames == 2);
  CHECK(std::strstr(m.whole_because, "did not pay") != nullptr);
  renderer->renderer.history.state.trial.rest = 3;
  m = measure(&renderer->renderer, 3);
  CHECK(m.whole_frames == 3);
  CHECK(std::strstr(m.whole_because, "retrying") != nullptr);
  CHECK(m.pixels_traced == 3 * 32 * 24);
}

// Goal: without coherence all pixels count as traced, and no reason is given. Method: off.
TEST_CASE("measure_counts_no_frames_without_coherence") {
  std::unique_ptr<TestRenderer> renderer = make_seesaw(CoherenceMode::off);
  const Measurement m = measure(&renderer->renderer, 2);
  CHECK(!m.coherent);
  CHECK(m.whole_frames == 0);
  CHECK(m.whole_because == nullptr);
  CHECK(m.pixels_traced == 2 * 32 * 24);
}
