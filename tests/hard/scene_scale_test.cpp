// The built-in scenes at other scales: HARDCASES row 29.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"
#include "support/hard_case.h"
#include "support/scaled_scene.h"

using namespace pocketray;

namespace {

Picture picture_of(const Scene& scene, const AccelInfo* accel, double seconds, Aov aov) {
  Settings settings;
  settings.width = effort_side(whole_gate() ? 320 : 80), settings.height = effort_side(whole_gate() ? 240 : 60);
  settings.threads = whole_gate() ? std::thread::hardware_concurrency() : 1;
  settings.memory_bytes = std::size_t(96) << 20;
  auto test = make_renderer(scene, settings, accel);
  REQUIRE(render_frame(&test->renderer, seconds, aov).ok);
  return Picture(test->renderer.image.begin(), test->renderer.image.end());
}

}  // namespace

// Goal: every built-in scene × 2^±20 gives the same picture, bit for bit, and depths × 2^±20: no absolute epsilon
// anywhere between a scene and its picture. Method: differential, every accelerator but brute force, the animated scene
// in motion.
TEST_CASE("hard_29_builtin_scenes_scaled_by_powers_of_two_same_image") {
  int scene_count;
  const BuiltinScene* list = builtin_list(&scene_count);
  for (int i = 0; i < scene_count; ++i) {
    if (kSoftFloats && std::string(list[i].name) != "seesaw") continue;  // the others take minutes
    auto built = build_builtin(list[i]);
    double seconds = is_animated(built->scene) ? 1.3 : 0;
    for (const AccelInfo* accel : kAccelList) {
      if (accel == &kBruteAccel) continue;
      Picture expected = picture_of(built->scene, accel, seconds, Aov::none);
      Picture depth = picture_of(built->scene, accel, seconds, Aov::depth);
      for (float k : {0x1p20f, 0x1p-20f}) {
        auto scaled = scale_scene(built->scene, k);
        Picture found = picture_of(scaled->scene, accel, seconds, Aov::none);
        Picture found_depth = picture_of(scaled->scene, accel, seconds, Aov::depth);
        std::uint64_t wrong = 0;
        for (std::size_t pixel = 0; pixel < found.size(); ++pixel)
          wrong +=
              std::memcmp(&found[pixel], &expected[pixel], sizeof(Vec3)) != 0 || found_depth[pixel] != depth[pixel] * k;
        INFO(std::string(list[i].name) << ", " << accel->name << ", x " << k);
        CHECK(wrong == 0);
        count_hard(found.size(), wrong, "every pixel the same bits");
      }
    }
  }
}
