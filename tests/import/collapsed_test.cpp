// Models with many triangles collapsed to a point: they render as by brute force on every path of a scene.
#include <vector>

#include "accel/accel_list.h"
#include "base/rng.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "scene/baked_file.h"
#include "session/heap_scene.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

float between(Rng* rng, float low, float high) { return low + (high - low) * next_float(rng); }

// A part of `triangle_count` triangles that grows out of a point within a second.
std::string growing_part(int triangle_count) {
  GltfWriter w;
  Rng rng = make_rng(1);
  std::vector<float> corners;
  for (int i = 0; i < 9 * triangle_count; ++i) corners.push_back(between(&rng, -1, 1));
  w.vec3s(corners);
  w.floats({0, 1});
  w.vec3s({0, 0, 0, 1, 1, 1});
  return w.glb(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{"
      "\"nodes\":[0]}],\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],\"channels\":[{\"sampler\":0,"
      "\"target\":{\"node\":0,\"path\":\"scale\"}}]}]");
}

// One triangle, and `point_count` more whose corners all equal its first.
std::string one_and_points(int point_count) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (int i = 0; i < point_count; ++i) text += "f 1 1 1\n";
  return text;
}

// Random triangles, some collapsed to the same point.
std::string some_collapsed(int triangle_count, int collapsed_count) {
  Rng rng = make_rng(2);
  std::string text = "v 0 0 0\n";
  for (int i = 0; i < 3 * triangle_count; ++i)
    text += "v " + std::to_string(between(&rng, -1, 1)) + " " + std::to_string(between(&rng, -1, 1)) + " " +
            std::to_string(between(&rng, -1, 1)) + "\n";
  for (int i = 0; i < triangle_count; ++i) {
    std::string first = std::to_string(3 * i + 2), second = std::to_string(3 * i + 3),
                third = std::to_string(3 * i + 4);
    text += i % triangle_count < collapsed_count ? "f 1 1 1\n" : "f " + first + " " + second + " " + third + "\n";
  }
  return text;
}

Settings small_settings() {
  Settings settings = settings_for(0, 16, 12);
  settings.memory_bytes = 4u << 20;
  return settings;
}

// Pictures at several times by an accelerator, one renderer for all of them.
std::vector<Picture> pictures(const Scene& scene, const AccelInfo* accel) {
  auto test = make_renderer(scene, small_settings(), accel);
  std::vector<Picture> all;
  for (double seconds : {0.0, 0.5, 1.0, 0.0}) {
    REQUIRE(render_frame(&test->renderer, seconds).ok);
    all.emplace_back(test->renderer.image.begin(), test->renderer.image.end());
  }
  return all;
}

}  // namespace

// Goal: a model with collapsed triangles renders, whoever builds its tree: the renderer, `bake` and a server
// (build_heap_accel()), or the reader of a .pray without an accelerator. Method: compare with brute force, bit for bit,
// while a part grows out of a point and shrinks back.
TEST_CASE("import_collapsed_triangles_render_as_by_brute_force") {
  TemporaryFolder folder;
  for (const auto& file :
       {std::make_pair("grows.glb", growing_part(288)), std::make_pair("points.obj", one_and_points(128)),
        std::make_pair("mixed.obj", some_collapsed(1000, 250))}) {
    INFO(file.first);
    ImportedScene imported = load(folder.write(file.first, file.second));
    BakedFile baked = bake(imported.scene);
    Scene opened;
    REQUIRE(baked_open(baked.data(), baked.size(), &opened).ok);
    CHECK(opened.accel.empty());
    std::vector<Picture> expected = pictures(imported.scene, &kBruteAccel);
    for (const AccelInfo* info : kAccelList) {
      INFO(info->name);
      CHECK(pictures(imported.scene, info) == expected);
      CHECK(pictures(opened, info) == expected);
      Scene accelerated = imported.scene;
      void* block = build_heap_accel(*info, imported.scene, &accelerated.accel);
      if (info == &kBruteAccel) accelerated.accel = {};
      REQUIRE(block != nullptr);
      CHECK(pictures(accelerated, info) == expected);
      give_block_back(block);
    }
  }
}
