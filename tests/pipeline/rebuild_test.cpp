// An accelerator without refit is rebuilt for every frame of a moving scene.
#include <doctest/doctest.h>

#include "accel/accel_list.h"
#include "engine/frame.h"
#include "scene/baked_file.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

AccelInfo without_refit(AccelInfo info) {
  info.refit = nullptr;
  return info;
}

std::size_t frame_bytes(const Renderer& renderer) {
  return renderer.memory.plan.arena_bytes[static_cast<int>(ArenaKind::frame)];
}

}  // namespace

// Goal: without refit() the pictures are the same and the memory is within the plan, with and without a baked
// accelerator. Method: a list entry for this test only, which has build() but no refit(); frames forth and back in
// time.
TEST_CASE("rebuild_stands_in_for_refit_within_the_plan") {
  auto generated = generate_scene(bit(Feature::animation) | bit(Feature::point_light), 3);
  Settings settings = settings_for(0, 24, 18);
  settings.memory_bytes = 4u << 20;
  BakedFile file = bake(generated->scene);
  for (const AccelInfo* known : kAccelList) {
    AccelInfo rebuilt = without_refit(*known);
    auto usual = make_renderer(generated->scene, settings, known);
    Scene scene = generated->scene;
    for (bool baked : {false, true}) {
      INFO(known->name << (baked ? ", baked" : ""));
      if (baked && usual->renderer.accel.built.data.empty()) continue;
      if (baked) scene.accel = usual->renderer.accel.built.data;
      auto test = make_renderer(scene, settings, &rebuilt);
      Renderer& renderer = test->renderer;
      for (double seconds : {0.0, 0.9, 0.3, 0.3}) {
        REQUIRE(render_frame(&usual->renderer, seconds).ok);
        REQUIRE(render_frame(&renderer, seconds).ok);
        Picture a(usual->renderer.image.begin(), usual->renderer.image.end()),
            b(renderer.image.begin(), renderer.image.end());
        CHECK(same_picture(a, b));
      }
      CHECK(renderer.memory.frame.used == 0);
      CHECK(renderer.memory.frame.used_max <= frame_bytes(renderer));
      CHECK(renderer.memory.persistent.used_max <=
            renderer.memory.plan.arena_bytes[static_cast<int>(ArenaKind::persistent)]);
    }
  }
}

// Goal: the scratch of per-frame builds is planned next to the output, which may be in use then; animations without
// moving vertices, and static scenes, only have the first build. Method: plans of the same scene.
TEST_CASE("rebuild_scratch_is_planned_beside_the_output") {
  constexpr std::size_t kOutput = 1u << 16;
  AccelInfo rebuilt = without_refit(kBvhAccel);
  for (bool moves : {false, true}) {
    auto generated = generate_scene(moves ? bit(Feature::animation) : 0, 3);
    Settings settings = settings_for(0, 24, 18);
    settings.memory_bytes = 4u << 20;
    auto test = make_renderer(generated->scene, settings, &rebuilt);
    MemoryPlan plan;
    REQUIRE(plan_memory(generated->scene, settings, test->renderer.effects, rebuilt, {}, {}, kOutput, &plan).ok);
    std::size_t scratch = kBvhAccel.scratch_need(generated->scene.triangles.count);
    std::size_t bytes = plan.arena_bytes[static_cast<int>(ArenaKind::frame)];
    CHECK(scratch > 0);
    CHECK(bytes == (moves ? scratch + kOutput : std::max(scratch, kOutput)) + kArenaAlignment);
  }
}
