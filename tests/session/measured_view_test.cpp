// The view of models without cameras, at rest and animated.
#include "session/measured_view.h"

#include <dirent.h>
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "accel/triangle.h"
#include "plan/plan_scene.h"
#include "scene/animate.h"
#include "session/heap_scene.h"
#include "support/generated_scene.h"
#include "support/picture_bounds.h"

using namespace pocketray;

namespace {

struct Posed {
  std::vector<std::uint8_t> memory;
  Pose pose;
};
void make_posed(const Scene& scene, Posed* posed) {
  posed->memory.resize(pose_need(scene) + kArenaAlignment);
  Arena arena = make_arena("pose", posed->memory.data(), posed->memory.size());
  posed->pose = make_pose(scene, &arena);
}

// The camera that opens the scene, whose view is measured, and what it shows at `count` times of an animation.
PictureBounds seen_while_playing(const Scene& scene, float aspect, std::uint32_t animation, int count) {
  const Box bounds = scene_bounds(scene);
  const Camera camera = default_camera(scene.default_view[0],
                                       find_framing(scene, scene.default_view[0], bounds, animation), bounds, aspect);
  Posed posed;
  make_posed(scene, &posed);
  PictureBounds seen;
  for (int i = 0; i < count; ++i) {
    if (is_animated(scene))
      pose_at(scene, animation, static_cast<double>(scene.animations[animation].duration) * (i + 0.37) / count,
              &posed.pose);
    Array<const Vec3> positions = scene.positions;
    if (!posed.pose.positions.empty()) positions = {posed.pose.positions.data, posed.pose.positions.count};
    for (const Triangle& t : scene.triangles)
      if (is_hittable(positions, t))
        for (std::uint32_t v : t.vertices()) add_point(camera, aspect, positions[v], &seen);
  }
  return seen;
}

void find_models(const std::string& folder, std::vector<std::string>* models) {
  DIR* open = opendir(folder.c_str());
  if (!open) return;
  while (const dirent* entry = readdir(open)) {
    const std::string name = entry->d_name, path = folder + "/" + name;
    struct stat info;
    if (name[0] == '.' || name == "hostile" || stat(path.c_str(), &info) != 0) continue;
    if (S_ISDIR(info.st_mode)) find_models(path, models);
    for (const char* ending : {".glb", ".gltf", ".obj", ".ply"})
      if (name.size() > 5 && name.find(ending) == name.size() - std::string(ending).size()) models->push_back(path);
  }
  closedir(open);
}

}  // namespace

// Goal: a model stays in the picture while it is animated, and fills it. Method: a mesh that moves,
// posed at times between those that were measured; at rest it reaches less far.
TEST_CASE("measured_view_holds_every_pose") {
  auto s = generate_scene(bit(Feature::animation) | bit(Feature::point_light), 5);
  const MovingMesh& mesh = s->moving_meshes[0];
  const auto rests = [&](const Triangle& t) {
    return t.vertex(0) < mesh.vertex_begin || t.vertex(0) >= mesh.vertex_begin + mesh.vertex_count;
  };
  s->triangles.erase(std::remove_if(s->triangles.begin(), s->triangles.end(), rests), s->triangles.end());
  s->cameras.clear(), s->bind();
  Scene still = s->scene;
  still.animations = {};
  MeasuredView moving_view, still_view;
  measure_view(&s->scene, &moving_view), measure_view(&still, &still_view);
  CHECK(s->scene.framings.data == moving_view.framings.data());
  REQUIRE(s->scene.framings.count == 2);
  REQUIRE(still.framings.count == 1);
  const Box bounds = scene_bounds(s->scene);
  const Framing at_rest = find_framing(s->scene, moving_view.view, bounds, kNone);
  CHECK(std::memcmp(&at_rest, &still.framings[0], sizeof at_rest) == 0);
  for (float aspect : {0.75f, 4.0f / 3}) {
    const PictureBounds seen = seen_while_playing(s->scene, aspect, 0, 20);
    CHECK(seen.inside(0.97f));
    CHECK(seen.fill() > 0.85f);
    CHECK(seen.fill() < 0.95f);
  }
  bool is_wider = false;
  for (std::uint32_t side = 0; side < kReachSides; ++side) {
    CHECK(moving_view.framings[0].reach[side][0] >= still_view.framings[0].reach[side][0]);
    is_wider |= moving_view.framings[0].reach[side][0] > still_view.framings[0].reach[side][0];
  }
  CHECK(is_wider);
}

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: models of others fill .85 to .95 of the picture's larger side and stay in it during each of their animations;
// rooms are seen from inside. Method: every sample without a camera, whatever it shows.
TEST_CASE("measured_view_frames_the_samples") {
  std::vector<std::string> models;
  find_models(POCKETRAY_SHARED "/scenes", &models);
  for (const std::string& path : models) {
    CAPTURE(path);
    HeapScene heap;
    ModelOptions options;
    options.texture_side_max = 16, options.studio = false;
    const Status status = read_heap_scene(path, options, &heap);
    REQUIRE_MESSAGE(status.ok, status.message);
    if (!heap.scene.cameras.empty()) continue;
    const Framing& framing = heap.scene.framings[0];
    if (framing.eye != framing.target) {
      const Box bounds = scene_bounds(heap.scene);
      CHECK(contains(bounds, Box{framing.eye, framing.eye}));
      continue;
    }
    const std::uint32_t count = heap.scene.animations.count;
    for (std::uint32_t i = 0; i < (count ? count : 1); ++i) {
      const PictureBounds seen = seen_while_playing(heap.scene, 4.0f / 3, i, count ? 20 : 1);
      CAPTURE(i);
      CAPTURE(seen.fill());
      CHECK(seen.inside(0.97f));
      CHECK(seen.fill() > 0.85f);
      CHECK(seen.fill() < 0.95f);
    }
  }
}
#endif
