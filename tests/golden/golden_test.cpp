#include <doctest/doctest.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "effect/setting_list.h"
#include "golden/golden_frames.h"
#include "scene/baked.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"
#include "support/hard_case.h"
#include "support/test_environment.h"

using namespace pocketray;

// Goal: the same pixels, bit for bit, with every compiler, optimisation and CPU (HARDCASES row 63), every accelerator
// and number of threads. Method: golden hashes, one table for all builds; .ci/run makes builds at both extremes.
TEST_CASE("hard_63_golden_frames_are_the_same_in_every_build") {
  count_assertions("the same hash in every build");
  int count, rows = 0;
  const BuiltinScene* list = builtin_list(&count);
  bool changed = false;
  std::string table;
  for (int i = 0; i < count; ++i) {
    auto built = build_builtin(list[i]);
    for (double seconds : {0.0, 1.5}) {
      if (seconds > 0 && !is_animated(built->scene)) continue;
      Settings settings = golden_settings(built->scene);
      Picture picture = render_picture(built->scene, settings, seconds);
      std::uint32_t scene = scene_hash(built->scene), frame = picture_hash(picture.data(), picture.size());
      const GoldenFrame* golden = nullptr;
      for (const GoldenFrame& g : kGoldenFrames)
        if (std::strcmp(g.scene, list[i].name) == 0 && g.seconds == seconds) golden = &g;
      char row[128];
      std::snprintf(row, sizeof row, "{\"%s\", %.1f, 0x%08x, 0x%08x},\n", list[i].name, seconds, scene, frame);
      table += row;
      ++rows;
      CAPTURE(std::string(list[i].name));
      CAPTURE(seconds);
      if (!golden) {
        changed = true;
        MESSAGE("no golden frame for this scene");
        continue;
      }
      if (golden->scene_hash != scene || golden->frame_hash != frame) changed = true;
      CHECK_MESSAGE(golden->scene_hash == scene, "the scene itself changed");
      CHECK(golden->frame_hash == frame);
      for (const AccelInfo* accel : kAccelList) {
        if (accel == &kBruteAccel && built->scene.triangles.count > 1000u / kEffortDivisor) continue;
        CAPTURE(std::string(accel->name));
        for (std::uint32_t threads : {3u, 1u, 2u, 7u}) {
          CAPTURE(threads);
          if (kEffortDivisor > 1 && threads != 3) continue;
          settings.threads = threads;
          picture = render_picture(built->scene, settings, seconds, accel);
          CHECK(picture_hash(picture.data(), picture.size()) == golden->frame_hash);
        }
      }
    }
  }
  if (changed || rows != static_cast<int>(sizeof kGoldenFrames / sizeof *kGoldenFrames)) {
    std::printf("tests/golden/frames.inc should be:\n%s", table.c_str());
    FAIL("the table of golden frames does not match");
  }
}

// Goal: the same of what frames of the built-in scenes do not show: shadows from an environment, and virtual lights.
TEST_CASE("hard_63_interleaved_light_is_the_same_in_every_build") {
  count_assertions("the same hash in every build");
  const TestEnvironment sky(16, 8, {0.5f, 0.6f, 0.7f}, [](const Vec3d& d, int) {
    return d.x > 0.75 ? Vec3d{8, 7, 6} : Vec3d{0.25, 0.5, 0.75};
  });
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    if (std::strcmp(list[i].name, "seesaw") != 0) continue;
    auto built = build_builtin(list[i]);
    sky.give(&built->scene);
    Settings settings = golden_settings(built->scene);
    for (bool bounces : {false, true}) {
      if (bounces) settings.indirect = indirect_choice(Effect::instant_radiosity);
      const Picture picture = render_picture(built->scene, settings, 1.5);
      CAPTURE(bounces);
      settings.environment_shadows = 0;
      CHECK_FALSE(same_picture(picture, render_picture(built->scene, settings, 1.5)));
      settings.environment_shadows = 32;
      CHECK(picture_hash(picture.data(), picture.size()) == (bounces ? 0xc6c8f67du : 0x5a436756u));
    }
  }
}
