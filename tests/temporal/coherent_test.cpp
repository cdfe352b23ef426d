#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <numeric>

#include "effect/setting_list.h"
#include "scene/builtin_helpers.h"
#include "support/feature_sets.h"
#include "support/hard_case.h"
#include "temporal/edit_script.h"

using namespace pocketray;

namespace {

std::uint64_t seed_of_scripts() {
  const char* seed = std::getenv("POCKETRAY_SEED");
  return seed ? std::strtoull(seed, nullptr, 10) : 1;
}

int script_count() {
  const char* count = std::getenv("POCKETRAY_SCRIPTS");
  return count ? std::atoi(count) : gate_share(kEffortDivisor > 6 ? 15 : 60, 1000);
}

struct Pair {
  std::unique_ptr<TestRenderer> whole, coherent;
};

Pair make_pair(const char* scene, Settings settings) {
  Pair pair;
  pair.whole = make_renderer(shared_builtin(scene)->scene, settings);
  settings.coherence = CoherenceMode::on;
  pair.coherent = make_renderer(shared_builtin(scene)->scene, settings);
  return pair;
}

bool same_frames(const Pair& pair, double seconds) {
  REQUIRE(render_frame(&pair.whole->renderer, seconds).ok);
  REQUIRE(render_frame(&pair.coherent->renderer, changes_at(seconds)).ok);
  const Array<Vec3>&a = pair.whole->renderer.image, &b = pair.coherent->renderer.image;
  return std::memcmp(a.data, b.data, a.bytes()) == 0;
}

}  // namespace

// Goal: HARDCASES 58 and 59. Method: differential, whole frames against coherent ones after random edits: moves down to
// fractions of an ulp, deformations, deletions, additions, objects that leave the grid, colours, textures, lights,
// camera, settings, with all effects, tables of all sizes, 1 to 3 threads and every accelerator; frames that were cut
// short or rendered otherwise in between, or of which only some rows were traced. Seeds and their number may be set:
// POCKETRAY_SEED, POCKETRAY_SCRIPTS.
TEST_CASE("hard_58_edited_frames_equal_whole_ones") {
  constexpr int kFrames = 20;
  const std::uint64_t first = seed_of_scripts();
  const int count = script_count();
  std::uint64_t frames = 0, wrong = 0, partial = 0, relit = 0, rows = 0, kept = 0, pixels = 0;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    Rng rng = make_rng(seed, 5);
    std::uint32_t features = next_u32(&rng) & kAllFeatures;
    if (next_u32(&rng) % 4 == 0) features &= next_u32(&rng);
    CAPTURE(seed);
    EditScript script = begin_script(features, seed);
    for (int frame = 0; frame < kFrames; ++frame, ++frames) {
      CAPTURE(frame);
      bool same = follow_script(&script);
      CHECK(same);
      wrong += !same;
    }
    partial += script.partial_frames, relit += script.partly_relit_frames;
    rows += script.shared.rows;
    kept += script.shared.pixels - script.shared.pixels_traced, pixels += script.shared.pixels;
    show_gate_progress(static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(count));
  }
  CHECK(frames > 0);
  if (kEffortDivisor == 1) {      // of few scripts, all may render whole frames
    CHECK(partial > frames / 8);  // the comparison is not one of whole frames with themselves,
    CHECK(relit > frames / 100);
    CHECK(rows > frames);
    CHECK(kept > pixels / 8);  // nor of rows with themselves
  }
  count_hard(frames, wrong, "every bit of every frame equal");
}

// Goal: the promise on the paper's sequence. Method: differential, over stretches of it, each from another place.
TEST_CASE("seesaw_frames_equal_whole_ones") {
  Settings settings;
  settings.width = effort_side(160), settings.height = effort_side(120);
  settings.threads = 2;
  Pair pair = make_pair("seesaw", settings);
  std::uint64_t traced = 0, pixels = 0;
  for (int begin : {0, 60, 300}) {
    for (TestRenderer* each : {pair.whole.get(), pair.coherent.get()}) {
      Camera camera = each->renderer.view.camera;
      camera.eye.x += 0.01f * static_cast<float>(begin);
      REQUIRE(set_camera(&each->renderer, camera).ok);
    }
    for (int frame = begin; frame < begin + effort(12); ++frame) {
      CAPTURE(frame);
      REQUIRE(same_frames(pair, frame / 30.0));
      const CoherenceState& state = pair.coherent->renderer.history.state;
      if (frame > begin) traced += state.pixels_traced, pixels += settings.width * settings.height;
    }
  }
  CHECK(traced * 2 <= pixels);
}

// Goal: light between surfaces is followed while what moves meets none of the walks that place virtual lights. Method:
// the first frames of the paper's sequence, where it meets none, and the 29th, where it does.
TEST_CASE("virtual_lights_that_rest_are_followed") {
  Settings settings;
  settings.width = effort_side(160), settings.height = effort_side(120);
  settings.threads = 2;
  settings.indirect = indirect_choice(Effect::instant_radiosity);
  Pair pair = make_pair("seesaw", settings);
  const Renderer& coherent = pair.coherent->renderer;
  std::uint64_t traced = 0, pixels = 0;
  for (int frame = 20; frame < 29; ++frame) {
    CAPTURE(frame);
    REQUIRE(same_frames(pair, frame / 30.0));
    if (frame == 20) continue;
    REQUIRE(coherent.history.state.whole_because == nullptr);
    traced += coherent.history.state.pixels_traced, pixels += settings.width * settings.height;
  }
  CHECK(traced > 0);
  CHECK(traced * 4 <= pixels);
  REQUIRE(same_frames(pair, 29 / 30.0));
  CHECK(std::string(coherent.history.state.whole_because) == "a virtual light changed");
  REQUIRE(same_frames(pair, 28 / 30.0));  // back to where they were before the last frame
}

namespace {

std::uint64_t ray_count(const Renderer& renderer) {
  const Tracer counts = total_counts(renderer);
  return std::accumulate(std::begin(counts.rays), std::end(counts.rays), std::uint64_t(0));
}

}  // namespace

// Goal: rays of compensation, and the shadow rays from where they end, are followed. Method: frames in which what moves
// meets no walk, with one sample and two. The rays of both.
TEST_CASE("compensated_virtual_lights_are_followed") {
  for (std::uint32_t samples : {1u, 2u}) {
    CAPTURE(samples);
    Settings settings;
    settings.width = effort_side(160), settings.height = effort_side(120);
    settings.threads = 2, settings.samples_per_pixel = samples;
    settings.indirect = indirect_choice(Effect::instant_radiosity), settings.compensation = Compensation::rays;
    Pair pair = make_pair("seesaw", settings);
    std::uint64_t whole_rays = 0, rays = 0;
    for (int frame = 20; frame < 29; ++frame) {
      CAPTURE(frame);
      REQUIRE(same_frames(pair, frame / 30.0));
      if (frame == 20) continue;
      REQUIRE(pair.coherent->renderer.history.state.whole_because == nullptr);
      whole_rays += ray_count(pair.whole->renderer), rays += ray_count(pair.coherent->renderer);
    }
    CAPTURE(static_cast<double>(rays) / static_cast<double>(whole_rays));
    CHECK(rays > 0);
    CHECK(10 * rays < 8 * whole_rays);  // .59 at full effort, .69 at a third of the side
  }
}

// Goal: compensation that memory was not planned for makes frames whole, and says so. Method: it is turned on later.
TEST_CASE("compensation_without_room_is_traced_whole") {
  Settings settings;
  settings.width = 40, settings.height = 30;
  settings.indirect = indirect_choice(Effect::instant_radiosity);
  Pair pair = make_pair("seesaw", settings);
  const CoherenceState& state = pair.coherent->renderer.history.state;
  for (int frame = 20; frame < 22; ++frame) REQUIRE(same_frames(pair, frame / 30.0));
  REQUIRE(state.whole_because == nullptr);
  for (TestRenderer* t : {pair.coherent.get(), pair.whole.get()}) {
    Settings changed = t->renderer.settings;
    changed.compensation = Compensation::rays;
    REQUIRE(change_settings(&t->renderer, changed).ok);
  }
  for (int frame = 22; frame < 26; ++frame) {
    REQUIRE(same_frames(pair, frame / 30.0));
    CHECK(std::string(state.whole_because) == "more samples, lights or effects than memory was planned for");
  }
}

// Goal: a frame in which nothing changed costs no ray. Method: the same time twice.
TEST_CASE("unchanged_frame_traces_nothing") {
  for (const char* scene : {"seesaw", "cornell", "cube"}) {
    CAPTURE(std::string(scene));
    Settings settings;
    settings.width = 64, settings.height = 48;
    Pair pair = make_pair(scene, settings);
    REQUIRE(same_frames(pair, 0.5));
    CHECK(pair.coherent->renderer.history.state.pixels_traced == 64 * 48);
    REQUIRE(same_frames(pair, 0.5));
    const CoherenceState& state = pair.coherent->renderer.history.state;
    CHECK(state.whole_because == nullptr);
    CHECK(state.pixels_traced == 0);
    CHECK(state.search.moving_rays + state.search.static_rays == 0);
    std::uint64_t rays = 0;
    for (std::uint64_t n : total_counts(pair.coherent->renderer).rays) rays += n;
    CHECK(rays == 0);
  }
}

// Goal: sliced frames are the same. Method: a deadline that has passed, so that each call traces one batch.
TEST_CASE("coherent_frame_in_slices_equals_whole_one") {
  Settings settings;
  settings.width = 64, settings.height = 48;
  Pair pair = make_pair("seesaw", settings);
  Renderer* renderer = &pair.coherent->renderer;
  for (int frame = 0; frame < 3; ++frame) {
    REQUIRE(begin_frame(renderer, {frame / 30.0, FramePurpose::changes}).ok);
    int calls = 1;
    while (!trace_frame(renderer, frame_source(renderer, nullptr, 0))) ++calls;
    CHECK((frame > 0 || calls > 1));
    REQUIRE(render_frame(&pair.whole->renderer, frame / 30.0).ok);
    CHECK(std::memcmp(renderer->image.data, pair.whole->renderer.image.data, renderer->image.bytes()) == 0);
  }
}

// Goal: each triangle that can move is found among them, and no other. Method: looked for in the list.
TEST_CASE("moving_triangles_are_found_among_all") {
  Settings settings;
  settings.width = 64, settings.height = 48;
  Pair pair = make_pair("seesaw", settings);
  const MovingGeometry& m = pair.coherent->renderer.history.coherence.moving;
  REQUIRE(m.ids.count > 0);
  std::uint32_t next = 0, wrong = 0;
  for (std::uint32_t i = 0; i < pair.coherent->renderer.scene.triangles.count; ++i) {
    const bool can_move = next < m.ids.count && m.ids[next] == i;
    wrong += moving_index(m, i) != (can_move ? next : kNoTriangle);
    next += can_move;
  }
  CHECK_EQ(next, m.ids.count);
  CHECK_EQ(wrong, 0);
  CHECK_EQ(moving_index(m, kNoTriangle), kNoTriangle);
}

// Goal: what memory does not allow is left out, with a reason. Method: a block in which only the plain frame fits.
TEST_CASE("coherence_without_room_is_left_out") {
  Settings settings;
  settings.width = 160, settings.height = 120;
  auto plain = make_renderer(shared_builtin("seesaw")->scene, settings);
  settings.memory_bytes = plain->renderer.memory.plan.total_bytes + 1024;
  settings.coherence = CoherenceMode::on;
  auto tight = make_renderer(shared_builtin("seesaw")->scene, settings);
  CHECK(!tight->renderer.history.state.planned);
  REQUIRE(render_frame(&tight->renderer, changes_at(0)).ok);
  REQUIRE(render_frame(&tight->renderer, changes_at(0)).ok);
  REQUIRE(tight->renderer.history.state.whole_because != nullptr);
  CHECK(std::string(tight->renderer.history.state.whole_because) == "coherence does not fit into memory");
  CHECK(tight->renderer.history.state.pixels_traced == 160 * 120);
}
