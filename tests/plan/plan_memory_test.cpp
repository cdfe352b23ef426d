#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "engine/progressive.h"
#include "plan/plan_effects.h"
#include "plan/plan_memory.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

std::size_t part_bytes(const MemoryPlan& plan, const char* name) {
  for (int i = 0; i < plan.part_count; ++i)
    if (std::strcmp(plan.parts[i].name, name) == 0) return plan.parts[i].bytes;
  return 0;
}

Settings settings_of(std::uint32_t features) {
  Settings settings = settings_for(features, 32, 24);
  settings.memory_bytes = 4u << 20;
  return settings;
}

}  // namespace

// Goal: the map adds up. Method: the total is the sum of its arenas, an arena the sum of its parts and of what
// alignment may take.
TEST_CASE("plan_memory_sums_its_parts") {
  for (std::uint32_t features : {0u, kAllFeatures, bit(Feature::emission), bit(Feature::animation)}) {
    auto generated = generate_scene(features, 2);
    auto test = make_renderer(generated->scene, settings_of(features));
    const MemoryPlan& plan = test->renderer.memory.plan;
    std::size_t sums[3] = {0, 0, 0}, total = 0;
    for (int i = 0; i < plan.part_count; ++i) sums[static_cast<int>(plan.parts[i].arena)] += plan.parts[i].bytes;
    for (int arena = 0; arena < 3; ++arena) {
      CHECK(plan.arena_bytes[arena] == (sums[arena] ? sums[arena] + kArenaAlignment : 0));
      total += plan.arena_bytes[arena];
    }
    CHECK(plan.total_bytes == total);
  }
}

// Goal: an absent effect takes no byte. Method: the parts that belong to an effect, with and without it.
TEST_CASE("plan_memory_has_no_part_for_an_absent_effect") {
  auto plan_for = [](std::uint32_t features, EffectMask off) {
    auto generated = generate_scene(features, 2);
    Settings settings = settings_of(features);
    settings.forced_off = off;
    return make_renderer(generated->scene, settings)->renderer.memory.plan;
  };
  CHECK(part_bytes(plan_for(bit(Feature::ambient), 0), "pose") == 0);
  CHECK(part_bytes(plan_for(bit(Feature::ambient), 0), "lights") == 0);
  CHECK(part_bytes(plan_for(bit(Feature::animation) | bit(Feature::ambient), 0), "pose") > 0);
  CHECK(part_bytes(plan_for(bit(Feature::animation) | bit(Feature::ambient), bit(Effect::animation)), "pose") == 0);
  CHECK(part_bytes(plan_for(bit(Feature::point_light), 0), "lights") == arena_need<LightPoint>(1));
  CHECK(part_bytes(plan_for(bit(Feature::emission), 0), "lights") ==
        arena_need<LightPoint>(2) + arena_need<LightPoint>(2 * kSampleCountMax) +  // 2 points per area light and sample
            arena_need<LightPolygon>(1));
  CHECK(part_bytes(plan_for(bit(Feature::emission) | bit(Feature::specular), 0), "lights") >
        arena_need<LightPoint>(9));  // 9 points, in groups
  CHECK(part_bytes(plan_for(bit(Feature::emission), bit(Effect::area_light)), "lights") == 0);
  CHECK(part_bytes(plan_for(bit(Feature::point_light), bit(Effect::point_light)), "lights") == 0);
}

// Goal: encrypted links are a part of their own, beside the output, and absent without a key; with a scene and without.
// Method: plans with and without them.
TEST_CASE("plan_memory_has_encrypted_links_of_their_own") {
  auto generated = generate_scene(bit(Feature::ambient), 2);
  auto test = make_renderer(generated->scene, settings_of(bit(Feature::ambient)));
  const Renderer& renderer = test->renderer;
  OutputNeed need(1000 * kArenaAlignment);
  std::size_t totals[2][2];
  for (std::size_t tls_bytes : {std::size_t(0), 700 * kArenaAlignment}) {
    need.tls_bytes = tls_bytes;
    MemoryPlan plan;
    REQUIRE(plan_output_memory(renderer.settings, need, &plan).ok);
    CHECK(part_bytes(plan, "output") == need.output_bytes);
    CHECK(part_bytes(plan, "encrypted links") == tls_bytes);
    totals[0][tls_bytes > 0] = plan.total_bytes;
    REQUIRE(
        plan_memory(generated->scene, renderer.settings, renderer.effects, *renderer.accel.info, {}, {}, need, &plan)
            .ok);
    CHECK(part_bytes(plan, "encrypted links") == tls_bytes);
    totals[1][tls_bytes > 0] = plan.total_bytes;
  }
  for (const auto& total : totals) CHECK(total[1] - total[0] == 700 * kArenaAlignment);
}

// Goal: a run stays inside its plan, and the plan is not much larger. Method: high-water marks of real runs.
TEST_CASE("plan_memory_holds_in_a_run") {
  for (std::uint32_t features : feature_sets()) {
    if (features % 3) continue;
    auto generated = generate_scene(features, features);
    auto test = make_renderer(generated->scene, settings_of(features));
    Renderer& renderer = test->renderer;
    REQUIRE(render_frame(&renderer, 0.5).ok);
    CAPTURE(features);
    CHECK(renderer.memory.persistent.used_max <=
          renderer.memory.plan.arena_bytes[static_cast<int>(ArenaKind::persistent)]);
    CHECK(renderer.memory.frame.used_max <= renderer.memory.plan.arena_bytes[static_cast<int>(ArenaKind::frame)]);
    CHECK(renderer.memory.frame.used == 0);
    // The accelerator's need is an upper bound; all else is exact.
    std::size_t planned = renderer.memory.plan.arena_bytes[static_cast<int>(ArenaKind::persistent)];
    CHECK(renderer.memory.persistent.used + part_bytes(renderer.memory.plan, "accelerator") + kArenaAlignment >=
          planned);
  }
}

// Goal: a scene that does not fit is refused with the figures, and the size suggested does fit. Method: limits from
// zero to enough; the size is read back from the message.
TEST_CASE("plan_memory_refusal_names_what_fits") {
  auto generated = generate_scene(kAllFeatures, 3);
  Settings settings = settings_for(kAllFeatures, 640, 480);
  for (std::size_t limit : {std::size_t(1) << 16, std::size_t(1) << 20, std::size_t(3) << 20}) {
    settings.memory_bytes = limit;
    Status status;
    CHECK(make_renderer(generated->scene, settings, nullptr, &status) == nullptr);
    std::string message = status.message;
    CAPTURE(message);
    CHECK(message.find("radiance") != std::string::npos);  // the largest part
    std::size_t at = message.find("; ", message.find(" MiB", message.find("largest")));
    REQUIRE(at != std::string::npos);
    settings.memory_bytes = std::strtoul(message.c_str() + at + 2, nullptr, 10) << 20;
    auto test = make_renderer(generated->scene, settings, nullptr, &status);
    REQUIRE(test);
    CHECK(begin_frame(&test->renderer, {0}).ok);
  }
}

// Goal: if the default accelerator does not fit, the compact one replaces it, unless another was requested. Method:
// limits around the need of each; the picture stays the same.
TEST_CASE("plan_memory_takes_the_compact_accelerator_where_the_default_does_not_fit") {
  auto generated = generate_scene(bit(Feature::point_light), 5);
  Settings settings = settings_for(0, 16, 12);
  auto plan_of = [&](const AccelInfo* accel) {
    return make_renderer(generated->scene, settings, accel)->renderer.memory.plan;
  };
  std::size_t bvh = plan_of(&kBvhAccel).total_bytes, compact = plan_of(&kCompactAccel).total_bytes;
  REQUIRE(compact < bvh - kArenaAlignment);
  Picture expected = render_picture(generated->scene, settings, 0, &kBvhAccel);
  Status status;
  auto try_with = [&](std::size_t bytes, const AccelInfo* accel) {
    settings.memory_bytes = bytes + kArenaAlignment;  // wherever the block starts
    return make_renderer(generated->scene, settings, accel, &status);
  };
  auto roomy = try_with(bvh, nullptr), tight = try_with(compact, nullptr);
  REQUIRE(roomy);
  REQUIRE(tight);
  CHECK(roomy->renderer.accel.info == &kBvhAccel);
  CHECK_FALSE(roomy->renderer.accel.is_fallback);
  CHECK(tight->renderer.accel.info == &kCompactAccel);
  CHECK(tight->renderer.accel.is_fallback);
  REQUIRE(render_frame(&tight->renderer, 0).ok);
  CHECK(std::memcmp(tight->renderer.image.data, expected.data(), tight->renderer.image.bytes()) == 0);
  CHECK_FALSE(try_with(compact, &kBvhAccel));
  CHECK_FALSE(try_with(compact / 2, nullptr));
}

// Goal: a block that just holds the plan is enough, and one byte less is refused rather than overrun, wherever the
// block starts. Method: all misalignments within a cache line, at the exact size.
TEST_CASE("plan_memory_is_exact_at_the_edge_for_any_alignment") {
  auto generated = generate_scene(bit(Feature::point_light), 4);
  Settings settings = settings_for(0, 16, 12);
  std::size_t need = make_renderer(generated->scene, settings)->renderer.memory.plan.total_bytes;
  std::vector<std::uint8_t> block(need + 4 * kArenaAlignment);
  int built = 0, refused = 0;
  for (std::size_t offset = 0; offset < kArenaAlignment; ++offset)
    for (std::size_t less : {0, 1, 63, 64, 128}) {
      Renderer r;
      start_renderer(block.data() + offset, need - less, settings, &r);
      r.accel.info = &kBvhAccel;
      r.scene = generated->scene;
      if (!plan_renderer(&r, SceneStorage(), 0).ok) {
        ++refused;
        continue;
      }
      REQUIRE(build_renderer(&r).ok);
      REQUIRE(render_frame(&r, 0).ok);
      ++built;
    }
  CHECK(built > 0);
  CHECK(refused >= 4 * 64);
}

// Goal: the map is drawn with one line per part and stays within its buffer, however short. Method: every length.
TEST_CASE("plan_memory_draws_within_its_buffer") {
  auto generated = generate_scene(kAllFeatures, 3);
  auto test = make_renderer(generated->scene, settings_of(kAllFeatures));
  const MemoryPlan& plan = test->renderer.memory.plan;
  char whole[4096];
  std::size_t length = draw_memory_plan(plan, whole, sizeof whole);
  CHECK(length == std::strlen(whole));
  for (int i = 0; i < plan.part_count; ++i) CHECK(std::strstr(whole, plan.parts[i].name) != nullptr);
  CHECK(std::strstr(whole, "of 4.0 MiB allowed") != nullptr);
  for (std::size_t size = 1; size <= length + 1; ++size) {
    std::string buffer(size + 1, '#');
    std::size_t drawn = draw_memory_plan(plan, &buffer[0], size);
    REQUIRE(drawn == size - 1);
    REQUIRE(std::memcmp(buffer.data(), whole, drawn) == 0);
    REQUIRE(buffer[size - 1] == 0);
    REQUIRE(buffer[size] == '#');
  }
}

// Goal: the map has room for every part at once. Method: a scene with every feature, many lights and an environment,
// all effects forced on, an accelerator built anew for every frame, changing materials and encrypted links.
TEST_CASE("plan_memory_has_room_for_all_parts_at_once") {
  auto generated = generate_scene(kAllFeatures, 2);
  const TestEnvironment even = even_environment({1, 1, 1});
  even.give(&generated->scene);
  Settings settings = settings_of(kAllFeatures);
  settings.forced_on = kAllEffects, settings.forced_off = bit(Effect::selective) | bit(Effect::undersampling);
  settings.coherence = CoherenceMode::on;
  settings.indirect = indirect_choice(Effect::instant_radiosity);
  settings.memory_bytes = 64u << 20;
  const EffectPlan effects = plan_effects(generated->scene, settings);
  OutputNeed need(1000);
  need.tls_bytes = 1000;
  for (const AccelInfo* accel : kAccelList) {
    MemoryPlan plan;
    CHECK(plan_memory(generated->scene, settings, effects, *accel, {1 << 20, 8}, {100, 100}, need, &plan).ok);
    CHECK(plan.part_count <= kMemoryPartMax);
    CHECK(part_bytes(plan, "coherence") > 0);
    CHECK(part_bytes(plan, "neighbouring pixels") > 0);
    CHECK(part_bytes(plan, "environment shadows") > 0);
  }
}

// Goal: settings that need more than planned are refused by the name of the setting, and others are not. Method: each
// setting at each value of its sweep, planned with the defaults and with the widest of all; one light point more than
// planned, which arenas round to as many bytes.
TEST_CASE("planned_memory_holds_the_widest_settings") {
  auto generated = generate_scene(kAllFeatures, 2);
  generated->lights.resize(20);
  generated->bind();
  const Scene& scene = generated->scene;
  std::vector<Quality> all;
  for (const SettingRow& row : kSettingList)
    for (int i = 0; i < row.sweep.count; ++i) {
      all.push_back(Quality());
      row.field.set(&all.back(), row.sweep.values[i]);
    }
  auto plan_for = [&](const Settings& settings) {
    PlannedFor planned;
    const EffectMask mask = plan_effects(scene, settings).mask;
    REQUIRE(check_planned(scene, {settings, mask, 1u << 20, 1u << 20, 1u << 20}, settings, mask, &planned).ok);
    return planned;
  };
  auto refusal = [&](const PlannedFor& planned, const Settings& settings) {
    PlannedFor in;
    const Status status = check_planned(scene, planned, settings, plan_effects(scene, settings).mask, &in);
    return status.ok ? std::string() : std::string(status.message);
  };
  Settings narrow;
  narrow.light_tolerance = 0;
  const Settings wide = widest_settings(scene, narrow, {all.data(), static_cast<std::uint32_t>(all.size())});
  CHECK(wide.indirect == indirect_choice(Effect::instant_radiosity));
  CHECK(wide.resolution != Resolution::full);
  CHECK(wide.points_per_area_light == 256);
  CHECK(wide.light_tolerance > 0);
  const PlannedFor planned = plan_for(wide), planned_narrow = plan_for(narrow);
  for (const Quality& quality : all) {
    Settings settings;
    static_cast<Quality&>(settings) = quality;
    CHECK(refusal(planned, settings).empty());
  }
  Settings more = narrow;
  more.indirect = indirect_choice(Effect::instant_radiosity);
  CHECK(refusal(planned_narrow, more) ==
        "memory is planned for --indirect auto: plan with --indirect instant-radiosity");
  more = narrow, more.light_tolerance = 0.125f;
  CHECK(refusal(planned_narrow, more) ==
        "memory is planned for --light-tolerance 0: plan with --light-tolerance 0.125");
  for (std::size_t lights = 1; lights < 20; ++lights) {
    generated->lights.resize(lights);
    generated->bind();
    PlannedFor one_less = plan_for(narrow);
    --one_less.light_points;
    CHECK_FALSE(refusal(one_less, narrow).empty());
  }
}
