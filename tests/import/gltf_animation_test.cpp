// Node, skin and morph animation of glTF, posed by scene/animate.
#include <vector>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "import/posed.h"

using namespace pocketray;

namespace {

Vec3 center_of(const Scene& scene, const Pose& pose, std::uint32_t mesh) {
  Box box = empty_box();
  const MovingMesh& m = scene.moving_meshes[mesh];
  for (std::uint32_t v = 0; v < m.vertex_count; ++v) box = merge(box, pose.positions[m.vertex_begin + v]);
  return center(box);
}
float width_of(const Scene& scene, const Pose& pose, std::uint32_t mesh) {
  Box box = empty_box();
  const MovingMesh& m = scene.moving_meshes[mesh];
  for (std::uint32_t v = 0; v < m.vertex_count; ++v) box = merge(box, pose.positions[m.vertex_begin + v]);
  return extent(box).x;
}

// Checks that stored positions and normals are those of animation 0 at time 0.
void check_starts_posed(const Scene& scene) {
  Posed posed(scene);
  pose_at(scene, 0, 0, &posed.pose);
  bool same = true;
  for (std::uint32_t v = 0; v < posed.pose.positions.count; ++v) same &= posed.pose.positions[v] == scene.positions[v];
  for (std::uint32_t v = 0; v < posed.pose.normals.count; ++v) same &= posed.pose.normals[v] == scene.normals[v];
  CHECK(same);
}

}  // namespace

// Goal: STEP, LINEAR and CUBICSPLINE of a node's translation. Method: closed forms at several times; the file starts
// posed at time 0, and a mesh beside the animated node stays where it is.
TEST_CASE("gltf_node_animation_interpolates_as_its_sampler_says") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.floats({0, 2});
  w.vec3s({10, 0, 0, 14, 0, 0});
  w.vec3s({0, 0, 0, 10, 0, 0, 1, 0, 0, 2, 0, 0, 14, 0, 0, 0, 0, 0});
  std::string animations;
  for (const char* sampler :
       {"\"output\":2,\"interpolation\":\"STEP\"", "\"output\":2", "\"output\":3,\"interpolation\":\"CUBICSPLINE\""})
    animations += std::string(animations.empty() ? "" : ",") + "{\"samplers\":[{\"input\":1," + sampler +
                  "}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}]}";
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write(
      "a.gltf",
      w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"children\":[1]},"
             "{\"mesh\":0,\"translation\":[0,0,7]},{\"mesh\":0,\"translation\":[0,50,0]}],\"scenes\":[{\"nodes\":"
             "[0,2]}],\"animations\":[" +
             animations + "]")));
  const Scene& s = imported.scene;
  REQUIRE(s.animations.count == 3);
  REQUIRE(s.moving_meshes.count == 1);
  CHECK(s.nodes.count == 1);  // only what moves is a node
  CHECK(s.animations[1].duration == 2);
  CHECK(s.info.frame_count == 60);
  CHECK(s.positions[s.moving_meshes[0].vertex_begin] == Vec3{10, 0, 7});
  check_starts_posed(s);
  Posed posed(s);
  auto x_at = [&](std::uint32_t animation, double time) {
    pose_at(s, animation, time, &posed.pose);
    CHECK(posed.pose.positions[5] == s.positions[5]);
    return posed.pose.positions[s.moving_meshes[0].vertex_begin].x;
  };
  CHECK(x_at(0, 1.5) == 10);
  CHECK(x_at(1, 0.5) == 11);
  CHECK(x_at(1, 1.5) == 13);
  // t = 1/2 over 2 s: ½·10 + ⅛·2·(out-tangent 1) + ½·14 − ⅛·2·(in-tangent 2).
  CHECK(x_at(2, 1) == doctest::Approx(5 + 0.25 + 7 - 0.5));
}

// Goal: a morph target by animated weights, and by default weights baked once. Method: one target that lifts one
// vertex.
TEST_CASE("gltf_morph_weights_move_or_are_applied_once") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.vec3s({0, 0, 0, 0, 0, 4, 0, 0, 0});
  w.floats({0, 1});
  w.floats({0, 1});
  std::string mesh =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":1}]}],\"weights\":[0.5]"
      "}],"
      "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]";
  TemporaryFolder folder;
  ImportedScene still = load(folder.write("still.gltf", w.gltf(mesh)));
  CHECK(still.scene.moving_meshes.count == 0);
  CHECK(still.scene.positions[1].z == 2);
  ImportedScene moving = load(folder.write(
      "moving.gltf",
      w.gltf(mesh + ",\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3}],\"channels\":[{\"sampler\":0,"
                    "\"target\":{\"node\":0,\"path\":\"weights\"}}]}]")));
  const Scene& s = moving.scene;
  REQUIRE(s.moving_meshes.count == 1);
  CHECK(s.positions[1].z == 0);
  check_starts_posed(s);
  Posed posed(s);
  pose_at(s, 0, 0.75, &posed.pose);
  CHECK(posed.pose.positions[1].z == 3);
}

// Goal: the sampler test's nine cubes move as its keys say. Method: translations and scales between keys by hand.
TEST_CASE("gltf_sample_interpolation_test_moves_nine_cubes") {
  std::string path = shared_scene("gltf/InterpolationTest.glb");
  if (!have(path)) return;
  ImportedScene imported = load(path);
  const Scene& s = imported.scene;
  REQUIRE(s.animations.count == 10);  // all together, and each
  REQUIRE(s.moving_meshes.count == 9);
  check_starts_posed(s);
  Posed posed(s);
  const double between = 0.5 * 0.4166666567325592;  // half-way from key 0 to key 1
  pose_at(s, 9, between, &posed.pose);
  CHECK(center_of(s, posed.pose, 8).y == doctest::Approx(0.5 * (6.621 + 10)).epsilon(1e-4));
  pose_at(s, 8, 0.5 * between, &posed.pose);  // a quarter: 3t² − 2t³ = 0.15625
  CHECK(center_of(s, posed.pose, 7).y == doctest::Approx(6.6401 + 0.15625 * (10 - 6.6401)).epsilon(1e-4));
  pose_at(s, 7, between, &posed.pose);
  CHECK(center_of(s, posed.pose, 6).y == doctest::Approx(6.6652).epsilon(1e-4));
  float full = width_of(s, posed.pose, 0);
  pose_at(s, 1, 0.5, &posed.pose);
  CHECK(width_of(s, posed.pose, 0) == doctest::Approx(0.5 * static_cast<double>(full)));
  pose_at(s, 2, 0.5 * (0.4166666567325592 + 0.875), &posed.pose);
  CHECK(width_of(s, posed.pose, 1) == doctest::Approx(0.75 * static_cast<double>(full)).epsilon(1e-3));
}

// Goal: skins. Method: SimpleSkin's upper end bends by a quarter turn about (0, 1, 0) at 1 s; robot and figures start
// posed.
TEST_CASE("gltf_sample_skins_bend") {
  std::string path = shared_scene("gltf/SimpleSkin/SimpleSkin.gltf");
  if (have(path)) {
    ImportedScene imported = load(path);
    const Scene& s = imported.scene;
    REQUIRE(s.moving_meshes.count == 1);
    CHECK(s.joints.count == 2);
    CHECK(bounds(s).high.y == 2);
    Posed posed(s);
    pose_at(s, 0, 1, &posed.pose);
    Vec3 tip = posed.pose.positions[9];  // at rest (0.5, 2, 0)
    CHECK(tip.x == doctest::Approx(-1).epsilon(1e-3));
    CHECK(tip.y == doctest::Approx(1.5).epsilon(1e-3));
  }
  for (const char* name : {"gltf/RiggedSimple.glb", "gltf/RiggedFigure.glb", "gltf/CesiumMan.glb", "gltf/Fox.glb",
                           "animation/robot.glb"}) {
    if (!have(shared_scene(name))) continue;
    CAPTURE(name);
    ImportedScene imported = load(shared_scene(name));
    CHECK(imported.scene.skins.count == 1);
    check_starts_posed(imported.scene);
    Posed posed(imported.scene);
    pose_at(imported.scene, 0, 0.4, &posed.pose);
    float moved = 0;
    for (std::uint32_t v = 0; v < posed.pose.positions.count; ++v)
      moved = std::max(moved, length(posed.pose.positions[v] - imported.scene.positions[v]));
    CHECK(moved > 0.01f * length(extent(bounds(imported.scene))));
  }
}

// Goal: the other animated samples. Method: the morph cube's keyed weights; only the milk truck's wheels move.
TEST_CASE("gltf_sample_morph_cube_and_milk_truck") {
  std::string cube = shared_scene("gltf/AnimatedMorphCube.glb");
  if (have(cube)) {
    ImportedScene imported = load(cube);
    const Scene& s = imported.scene;
    REQUIRE(s.moving_meshes.count == 1);
    CHECK(s.moving_meshes[0].morph_count == 2);
    Posed posed(s);
    pose_at(s, 0, 1.5999997854232788, &posed.pose);  // a key: weights 1 and 0
    const MovingMesh& mesh = s.moving_meshes[0];
    bool as_keyed = true;
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
      Vec3 target = s.rest_positions[v] + s.morph_positions[v];
      as_keyed &= length(posed.pose.positions[v] - transform_point(posed.pose.nodes[0], target)) < 1e-3f;
    }
    CHECK(as_keyed);
  }
  std::string truck = shared_scene("gltf/CesiumMilkTruck.glb");
  if (have(truck)) {
    ImportedScene imported = load(truck);
    CHECK(imported.scene.moving_meshes.count == 2);
    CHECK(imported.scene.moving_meshes[0].vertex_count < imported.scene.positions.count / 2);
    check_starts_posed(imported.scene);
  }
}
