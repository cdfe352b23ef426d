// What changed materials look like.
#include <doctest/doctest.h>

#include <cstring>

#include "effect/setting_list.h"
#include "engine/recolor.h"
#include "support/effort.h"
#include "temporal/edit_script.h"

using namespace pocketray;

// Goal: everything that is derived from materials follows them. Method: differential, random changes of random scenes
// against the same scene opened with the changed materials and the same effects; nothing moves, so that what is not
// made anew stays.
TEST_CASE("recolored_frames_equal_those_of_a_scene_opened_so") {
  std::uint64_t changes = 0;
  for (int i = 0; i < effort(240); ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Rng rng = make_rng(seed, 13);
    const std::uint32_t features = next_u32(&rng) & kAllFeatures & ~bit(Feature::animation);
    Settings settings = settings_for(features, 40, 30);
    if (next_u32(&rng) % 3 == 0)
      settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = 40;
    if (next_u32(&rng) % 3 == 0) settings.area_irradiance = AreaIrradiance::points;
    auto scene = generate_scene(features, seed), opened = generate_scene(features, seed);
    for (GeneratedScene* each : {scene.get(), opened.get()}) {
      if (seed % 4 != 0) continue;
      settings.light_tolerance = 0.1f;
      for (int k = 0; k < 24; ++k) {
        Light light;
        light.position = {static_cast<float>(k % 5) - 2, 3, static_cast<float>(k / 5) - 2}, light.intensity = {1, 1, 1};
        each->lights.push_back(light);
      }
      each->bind();
    }
    auto changed = make_renderer(scene->scene, settings, nullptr, nullptr, true);
    REQUIRE(render_frame(&changed->renderer, 0).ok);
    for (int k = 0; k < 6; ++k) {
      const std::uint32_t index = next_u32(&rng) % static_cast<std::uint32_t>(scene->materials.size());
      const Material m = recolored(scene->materials[index], changed->renderer.materials.current[index],
                                   static_cast<std::uint32_t>(scene->textures.size()), &rng);
      if (!check_recolored(&changed->renderer, index, m).ok) continue;
      changes += change_material(&changed->renderer, index, m).ok;
      opened->materials[index] = changed->renderer.materials.current[index];
    }
    REQUIRE(render_frame(&changed->renderer, 0).ok);
    opened->bind();
    settings.forced_on = changed->renderer.effects.mask;
    auto fresh = make_renderer(opened->scene, settings);
    if (VirtualLights* lights = virtual_lights_of(fresh->renderer.frame.indirect)) {  // as many walks as when it opened
      const VirtualLights& as_opened = *virtual_lights_of(changed->renderer.frame.indirect);
      lights->lights_per_walk = as_opened.lights_per_walk, lights->area = as_opened.area;
      fresh->renderer.lights.lit_mask = ~fresh->renderer.effects.mask, fresh->renderer.frame.view.cone = {0, 0};
    }
    REQUIRE(render_frame(&fresh->renderer, 0).ok);
    const Array<Vec3>&a = changed->renderer.image, &b = fresh->renderer.image;
    CHECK(std::memcmp(a.data, b.data, a.bytes()) == 0);
  }
  CHECK(changes > 0);
}
