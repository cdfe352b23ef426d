#include <doctest/doctest.h>

#include <vector>

#include "builtin_helpers.h"
#include "scene/animate.h"
#include "scene/builtin/seesaw_motion.h"

using namespace pocketray;

namespace {

struct Posed {
  const BuiltScene* built = shared_builtin("seesaw");
  std::vector<std::uint8_t> block;
  Arena arena;
  Pose pose;
  Posed() : block(pose_need(built->scene) + kArenaAlignment) {
    arena = make_arena("pose", block.data(), block.size());
    pose = make_pose(built->scene, &arena);
  }
  void at_frame(std::uint32_t frame) {
    pose_at(built->scene, 0, frame / static_cast<double>(built->scene.info.frames_per_second), &pose);
  }
  Box bounds(std::uint32_t mesh_index) const {
    const MovingMesh& mesh = built->scene.moving_meshes[mesh_index];
    Box box = empty_box();
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) box = merge(box, pose.positions[mesh.vertex_begin + v]);
    return box;
  }
  std::vector<Vec3> positions() const { return {pose.positions.begin(), pose.positions.end()}; }
};
enum { kBoard, kWeight, kWorm };

}  // namespace

// Goal: the sequence has the numbers of [Jevans92] sec. 5. Method: read them.
TEST_CASE("builtin_seesaw_has_351_frames_4_lights_and_a_static_camera") {
  const BuiltScene* built = shared_builtin("seesaw");
  const Scene& scene = built->scene;
  CHECK(scene.info.frame_count == 351);
  CHECK(scene.lights.count == 4);
  REQUIRE(scene.cameras.count == 1);
  CHECK(scene.cameras[0].node == kNone);
  REQUIRE(scene.animations.count == 1);
  // The last frame comes before the time wraps.
  CHECK(350 / scene.info.frames_per_second < scene.animations[0].duration);
  CHECK(is_animated(scene));
}

// Goal: Scene::positions hold time 0. Method: pose it, compare bits.
TEST_CASE("builtin_seesaw_scene_is_the_pose_at_time_0") {
  Posed posed;
  posed.at_frame(200);
  posed.at_frame(0);
  const Scene& scene = posed.built->scene;
  std::uint32_t different = 0;
  for (std::uint32_t v = 0; v < scene.positions.count; ++v)
    different += posed.pose.positions[v] != scene.positions[v] || posed.pose.normals[v] != scene.normals[v];
  CHECK(different == 0);
}

// Goal: the story: the weight falls on the board, the worm flies, lands on the floor and stays. Method: bounds of the
// three moving meshes frame by frame; nothing may sink into the floor or leave the tent.
TEST_CASE("builtin_seesaw_weight_launches_the_worm_and_it_lands") {
  Posed posed;
  posed.at_frame(0);
  Box weight_start = posed.bounds(kWeight), worm_start = posed.bounds(kWorm);
  float highest = 0, lowest = 1e9f;
  for (std::uint32_t frame = 0; frame < 351; frame += 2) {
    posed.at_frame(frame);
    Box worm = posed.bounds(kWorm);
    highest = worm.low.y > highest ? worm.low.y : highest;
    for (std::uint32_t mesh = 0; mesh < 3; ++mesh) {
      float low = posed.bounds(mesh).low.y;
      lowest = low < lowest ? low : lowest;
    }
  }
  CHECK(highest > 3.5f);
  CHECK(lowest > -0.03f);
  posed.at_frame(350);
  Box weight_end = posed.bounds(kWeight), worm_end = posed.bounds(kWorm);
  CHECK(weight_end.low.y < weight_start.low.y - 4);
  CHECK(std::fabs(worm_end.low.y) < 0.03f);
  CHECK(worm_end.high.z > worm_start.high.z + 1);
  CHECK(worm_end.high.y > 2.2f);
}

// Goal: little moves late in the sequence [Jevans92] table 2, but something always does. Method: the longest distance
// that a vertex moves between frames.
TEST_CASE("builtin_seesaw_calms_down_after_frame_150") {
  Posed posed;
  float early = 0, late = 0;
  for (std::uint32_t frame : {1u, 15u, 34u, 40u, 75u, 150u, 200u, 350u}) {
    posed.at_frame(frame - 1);
    std::vector<Vec3> before = posed.positions();
    posed.at_frame(frame);
    float way = 0;
    for (std::uint32_t v = 0; v < posed.pose.positions.count; ++v) {
      float d = length(posed.pose.positions[v] - before[v]);
      way = d > way ? d : way;
    }
    CAPTURE(frame);
    CHECK(way > 0);
    float& most = frame <= 75 ? early : late;
    most = way > most ? way : most;
  }
  CHECK(early > 0.15f);
  CHECK(late < 0.03f);
}

// Goal: the motion has no jumps. Method: nothing moves faster than 20 m/s between frames.
TEST_CASE("builtin_seesaw_motion_is_continuous") {
  SeesawState before = seesaw_at(0);
  for (int step = 1; step <= 11700; ++step) {
    SeesawState now = seesaw_at(step / 1000.0);
    CAPTURE(step);
    CHECK(length(now.body_position - before.body_position) < 0.02f);
    CHECK(length(now.weight_position - before.weight_position) < 0.02f);
    CHECK(std::fabs(now.board_angle - before.board_angle) < 0.01f);
    for (int k = 0; k < kWormJoints; ++k) CHECK(std::fabs(now.joint_angle[k] - before.joint_angle[k]) < 0.05f);
    before = now;
  }
}

// Goal: between the frames the worm takes the short way, even where its somersault ends. Method: in half a frame no
// vertex moves further than at 30 m/s.
TEST_CASE("builtin_seesaw_poses_between_frames_are_between") {
  Posed posed;
  const double frame_seconds = 1 / static_cast<double>(posed.built->scene.info.frames_per_second);
  posed.at_frame(0);
  std::vector<Vec3> before = posed.positions();
  float longest = 0;
  for (int half = 1; half < 220; ++half) {
    pose_at(posed.built->scene, 0, half * frame_seconds / 2, &posed.pose);
    for (std::uint32_t v = 0; v < posed.pose.positions.count; v += 7) {
      float way = length(posed.pose.positions[v] - before[v]);
      longest = way > longest ? way : longest;
    }
    before = posed.positions();
  }
  CHECK(longest < 0.5f);
}
