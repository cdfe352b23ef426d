#include "scene/animate.h"

#include <doctest/doctest.h>

#include <cfenv>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <vector>

#include "base/fmath.h"
#include "scene/baked.h"
#include "scene/full_scene.h"

using namespace pocketray;

namespace {

// One animated node with one channel, a mesh of one vertex at (1, 0, 0) with normal (1, 0, 0), a light and a camera on
// it.
struct Stage {
  FullScene full;
  std::vector<std::uint8_t> block;
  Arena arena;
  Pose pose;

  Stage() {
    full.positions = {{1, 0, 0}, {5, 5, 5}}, full.normals = {{1, 0, 0}, {0, 1, 0}};
    full.rest_positions = {{1, 0, 0}}, full.rest_normals = {{1, 0, 0}};
    full.nodes = {Node()};
    full.moving_meshes = {{0, 1, 0, 0, kNone, 0, 0, 0, Transform()}};
    full.animations = {{0, 1, 4}};
  }
  void channel(ChannelPath path, Interpolation interpolation, std::vector<float> times, std::vector<float> values) {
    full.channels = {{0, 0, static_cast<std::uint32_t>(times.size()), 0, path, interpolation}};
    full.key_times = times, full.key_values = values;
  }
  void start() {
    full.bind();
    Status status = validate_scene(full.scene);
    REQUIRE_MESSAGE(status.ok, status.message);
    block.assign(pose_need(full.scene) + 63, 0xCD);
    arena = make_arena("pose", block.data(), block.size());
    pose = make_pose(full.scene, &arena);
  }
  Vec3 vertex(double seconds) {
    pose_at(full.scene, 0, seconds, &pose);
    return pose.positions[0];
  }
};

void check_near(const Vec3& a, const Vec3& b, double tolerance = 1e-6) {
  CAPTURE(a.x);
  CAPTURE(a.y);
  CAPTURE(a.z);
  CHECK(std::fabs(a.x - b.x) <= tolerance);
  CHECK(std::fabs(a.y - b.y) <= tolerance);
  CHECK(std::fabs(a.z - b.z) <= tolerance);
}

constexpr float kHalf = 0.70710678f;

}  // namespace

// Goal: a value holds until its next key. Method: just before, at and after a key.
TEST_CASE("animate_step_holds_until_the_next_key") {
  Stage stage;
  stage.channel(ChannelPath::translation, Interpolation::step, {1, 2, 3}, {0, 1, 0, 0, 9, 0, 0, 5, 0});
  stage.start();
  CHECK(stage.vertex(1).y == 1);
  CHECK(stage.vertex(1.999999).y == 1);
  CHECK(stage.vertex(2).y == 9);
  CHECK(stage.vertex(2.5).y == 9);
  CHECK(stage.vertex(3).y == 5);
}

// Goal: linear between keys, constant before the first and after the last; exact at keys.
TEST_CASE("animate_linear_interpolates_and_clamps_at_both_ends") {
  Stage stage;
  stage.channel(ChannelPath::translation, Interpolation::linear, {1, 2, 3}, {0, 0, 0, 0, 8, 4, 0, 8, -4});
  stage.start();
  CHECK(stage.vertex(0.25) == Vec3{1, 0, 0});
  CHECK(stage.vertex(1.25) == Vec3{1, 2, 1});
  CHECK(stage.vertex(2) == Vec3{1, 8, 4});
  CHECK(stage.vertex(2.5) == Vec3{1, 8, 0});
  CHECK(stage.vertex(3) == Vec3{1, 8, -4});
  CHECK(stage.vertex(3.75) == Vec3{1, 8, -4});
}

// Goal: [glTF 2.0, appendix C.5]. Method: keys and tangents of p(t) = t³ − 2t² + 3 over two seconds: a Hermite spline
// is exact for cubics. Tangents are per second, so the key distance of 2 shows whether they are scaled by it.
TEST_CASE("animate_cubic_spline_reproduces_a_cubic") {
  Stage stage;
  auto value = [](float t) { return t * t * t - 2 * t * t + 3; };
  auto slope = [](float t) { return 3 * t * t - 4 * t; };
  std::vector<float> values;
  for (float t : {0.0f, 2.0f, 3.0f})
    for (float y : {slope(t), value(t), slope(t)}) values.insert(values.end(), {0, y, 0});
  stage.channel(ChannelPath::translation, Interpolation::cubic, {0, 2, 3}, values);
  stage.start();
  for (float t : {0.0f, 0.125f, 0.5f, 1.0f, 1.75f, 2.0f, 2.5f, 3.0f})
    check_near(stage.vertex(t), {1, value(t), 0}, 1e-6);
  CHECK(stage.vertex(3.5).y == value(3));
}

// Goal: slerp has constant angular speed. Method: a rotation by 90° about z puts (1, 0, 0) at angle 90°·t.
TEST_CASE("animate_rotation_turns_at_constant_speed") {
  Stage stage;
  stage.channel(ChannelPath::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});
  stage.start();
  for (double t : {0.0, 0.1, 0.25, 0.5, 0.9, 1.0}) {
    CAPTURE(t);
    double angle = t * kPi / 2;
    Vec3 expected = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0};
    check_near(stage.vertex(t), expected);
    check_near(stage.pose.normals[0], expected);
  }
}

// Goal: the shorter of two arcs. Method: the negated second key is the same rotation; half-way must still be 45°.
TEST_CASE("animate_rotation_takes_the_shorter_arc") {
  Stage stage;
  stage.channel(ChannelPath::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, -kHalf, -kHalf});
  stage.start();
  check_near(stage.vertex(0.5), {kHalf, kHalf, 0});
}

// Goal: neither equal keys nor keys 1e-4 apart lose precision. Method: angles down to zero; half-way is half the angle.
TEST_CASE("animate_rotation_between_almost_equal_keys_is_accurate") {
  for (double angle : {0.0, 1e-7, 1e-4, 1e-3, 2.8e-3, 3e-3, 1e-2, 0.25}) {
    CAPTURE(angle);
    Stage stage;
    stage.channel(ChannelPath::rotation, Interpolation::linear, {0, 1},
                  {0, 0, 0, 1, 0, 0, static_cast<float>(std::sin(angle / 2)), static_cast<float>(std::cos(angle / 2))});
    stage.start();
    check_near(stage.vertex(0.25),
               {static_cast<float>(std::cos(angle / 4)), static_cast<float>(std::sin(angle / 4)), 0}, 1e-7);
  }
}

// Goal: cubic rotations are normalised; keys without direction give the identity, never NaN.
TEST_CASE("animate_rotation_by_spline_is_normalised_and_zero_is_the_identity") {
  Stage stage;
  std::vector<float> values(24, 0.0f);
  values[7] = 5, values[18] = 5;  // identity and a half turn about z, both five times too long, no tangents
  stage.channel(ChannelPath::rotation, Interpolation::cubic, {0, 1}, values);
  stage.start();
  check_near(stage.vertex(0), {1, 0, 0});
  check_near(stage.vertex(0.5), {0, 1, 0});
  values.assign(24, 0.0f);
  stage.full.key_values = values;
  stage.full.bind();
  check_near(stage.vertex(0.5), {1, 0, 0});
}

// Goal: time wraps at the duration, in both directions, and the duration itself shows time 0.
TEST_CASE("animate_time_wraps_at_the_duration") {
  Stage stage;
  stage.channel(ChannelPath::translation, Interpolation::linear, {0, 4}, {0, 0, 0, 0, 8, 0});
  stage.start();
  CHECK(stage.vertex(3).y == 6);
  CHECK(stage.vertex(4).y == 0);
  CHECK(stage.vertex(5).y == 2);
  CHECK(stage.vertex(4e6 + 1).y == 2);
  CHECK(stage.vertex(-1).y == 6);
  CHECK(stage.vertex(-1e-30).y == 0);
  CHECK(stage.vertex(std::numeric_limits<double>::quiet_NaN()).y == 0);
  CHECK(stage.vertex(std::numeric_limits<double>::infinity()).y == 0);
}

// Goal: an animation with one key, or of zero length, shows that key at every time.
TEST_CASE("animate_single_key_holds_at_every_time") {
  for (Interpolation interpolation : {Interpolation::step, Interpolation::linear, Interpolation::cubic}) {
    Stage stage;
    std::vector<float> values = {0, 3, 0};
    if (interpolation == Interpolation::cubic) values = {7, 7, 7, 0, 3, 0, 7, 7, 7};
    stage.channel(ChannelPath::translation, interpolation, {1}, values);
    stage.full.animations[0].duration = interpolation == Interpolation::step ? 0.0f : 1.0f;
    stage.start();
    for (double t : {0.0, 0.5, 0.999, 1.0, 7.3}) CHECK(stage.vertex(t) == Vec3{1, 3, 0});
  }
}

// Goal: children follow their parents, nearest first. Method: a parent that moves and rotates, a child that is offset
// and scaled; composed by hand.
TEST_CASE("animate_nodes_follow_their_parents") {
  Stage stage;
  Node child;
  child.parent = 0, child.translation = {2, 0, 0}, child.scale = {3, 1, 1};
  stage.full.nodes = {Node(), child};
  stage.full.nodes[0].rotation = {0, 0, kHalf, kHalf};
  stage.full.moving_meshes[0].node = 1;
  stage.channel(ChannelPath::translation, Interpolation::linear, {0, 2}, {0, 0, 0, 10, 0, 0});
  stage.start();
  check_near(stage.vertex(1), {5, 5, 0}, 1e-5);  // 1 → 3 → 5 along x, turned to y, moved by 5 along x
}

// Goal: an instance's transform lies between node and mesh and applies to normals. Method: a mirrored and stretched
// instance.
TEST_CASE("animate_instances_place_the_same_rest_pose") {
  Stage stage;
  Transform mirrored;
  mirrored.m[0][0] = -2, mirrored.m[1][3] = 7;
  stage.full.moving_meshes.push_back({1, 1, 0, 0, kNone, 0, 0, 0, mirrored});
  stage.channel(ChannelPath::translation, Interpolation::linear, {0, 1}, {0, 0, 0, 0, 0, 4});
  stage.start();
  check_near(stage.vertex(0.5), {1, 0, 2});
  check_near(stage.pose.positions[1], {-2, 7, 2});
  check_near(stage.pose.normals[1], {-1, 0, 0});
}

// Goal: morph targets add up before anything else. Method: two targets, weights animated from (0, 1) to (1, 0).
TEST_CASE("animate_morph_targets_add_weighted_deltas") {
  Stage stage;
  stage.full.weights = {0, 0}, stage.full.nodes[0].weight_count = 2, stage.full.nodes[0].scale = {1, 1, 2};
  stage.full.morph_positions = {{0, 0, 4}, {0, 8, 0}}, stage.full.morph_normals = {{-1, 0, 1}, {0, 0, 0}};
  stage.full.moving_meshes[0].morph_count = 2;
  stage.channel(ChannelPath::weights, Interpolation::linear, {0, 1}, {0, 1, 1, 0});
  stage.start();
  check_near(stage.vertex(0), {1, 8, 0});
  check_near(stage.pose.normals[0], {1, 0, 0});
  check_near(stage.vertex(0.25), {1, 6, 2});
  check_near(stage.vertex(3), {1, 0, 8});
  check_near(stage.pose.normals[0], {0, 0, 1});
}

namespace {

// Two joints along x, the second at x = 1, bent about z by the channel; vertices at x = 0.5, 1 and 2.
void two_bones(Stage* stage) {
  Node fore_arm;
  fore_arm.parent = 0, fore_arm.translation = {1, 0, 0};
  stage->full.nodes = {Node(), fore_arm};
  stage->channel(ChannelPath::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});
  stage->full.channels[0].node = 1;
  stage->full.joints = {{0, Transform()}, {1, Transform()}};
  stage->full.joints[1].inverse_bind.m[0][3] = -1;
  stage->full.skins = {{0, 2}};
  stage->full.rest_positions = {{0.5f, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  stage->full.positions = stage->full.rest_positions;
  stage->full.normals = stage->full.rest_normals = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
  stage->full.skin_weights = {
      {{0, 0, 0, 0}, {1, 0, 0, 0}}, {{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}}, {{1, 0, 0, 0}, {1, 0, 0, 0}}};
  stage->full.moving_meshes = {{0, 3, 0, kNone, 0, 0, 0, 0, Transform()}};
}

}  // namespace

// Goal: a skin in its bind pose changes nothing, whatever the mesh's own node does.
TEST_CASE("animate_skin_in_bind_pose_is_the_rest_pose") {
  Stage stage;
  two_bones(&stage);
  Node elsewhere;
  elsewhere.translation = {100, 100, 100};
  stage.full.nodes.push_back(elsewhere);
  stage.full.moving_meshes[0].node = 2;
  stage.start();
  pose_at(stage.full.scene, 0, 0, &stage.pose);
  for (int v = 0; v < 3; ++v) {
    CHECK(stage.pose.positions[v] == stage.full.rest_positions[v]);
    CHECK(stage.pose.normals[v] == stage.full.rest_normals[v]);
  }
}

// Goal: linear blend skinning [glTF 2.0, sec. 3.7.3.3]. Method: the fore-arm at 90°: its tip turns about the elbow, the
// elbow itself stays, the upper arm does not move, the elbow's normal lies half-way.
TEST_CASE("animate_skin_bends_two_bones") {
  Stage stage;
  two_bones(&stage);
  stage.start();
  pose_at(stage.full.scene, 0, 1, &stage.pose);
  check_near(stage.pose.positions[0], {0.5f, 0, 0});
  check_near(stage.pose.positions[1], {1, 0, 0});
  check_near(stage.pose.positions[2], {1, 1, 0});
  check_near(stage.pose.normals[0], {0, 1, 0});
  check_near(stage.pose.normals[1], {-kHalf, kHalf, 0});
  check_near(stage.pose.normals[2], {-1, 0, 0});
}

// Goal: lights and cameras with a node follow it, others stay; posed ones are marked as being in world space.
TEST_CASE("animate_lights_and_cameras_follow_their_nodes") {
  Stage stage;
  Light lamp, fixed;
  lamp.kind = LightKind::spot, lamp.node = 0, lamp.position = {1, 0, 0}, lamp.direction = {1, 0, 0};
  fixed.position = {3, 4, 5};
  stage.full.lights = {lamp, fixed};
  Camera flying, still;
  flying.node = 0, flying.eye = {0, 0, 1}, flying.target = {1, 0, 0}, flying.up = {0, 1, 0};
  stage.full.cameras = {flying, still};
  stage.full.nodes[0].translation = {0, 0, 10}, stage.full.nodes[0].scale = {2, 2, 2};
  stage.channel(ChannelPath::rotation, Interpolation::step, {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});
  stage.start();
  pose_at(stage.full.scene, 0, 1, &stage.pose);
  check_near(stage.pose.lights[0].position, {0, 2, 10});
  check_near(stage.pose.lights[0].direction, {0, 1, 0});
  CHECK(stage.pose.lights[0].node == kNone);
  CHECK(stage.pose.lights[1].position == fixed.position);
  check_near(stage.pose.cameras[0].eye, {0, 0, 12});
  check_near(stage.pose.cameras[0].target, {0, 2, 10});
  check_near(normalize(stage.pose.cameras[0].up), {-1, 0, 0});
  CHECK(stage.pose.cameras[0].node == kNone);
  CHECK(stage.pose.cameras[1].target == still.target);
}

// Goal: a pose depends only on its time, and vertices that do not move are the scene's. Method: every array in use;
// pose in different orders and compare bytes.
TEST_CASE("animate_pose_is_a_function_of_time") {
  FullScene full;
  make_full_scene(4, 20, 5, &full);
  std::size_t need = pose_need(full.scene);
  std::vector<std::uint8_t> block(2 * need + 63, 0xEE);
  Arena arena = make_arena("poses", block.data(), block.size());
  Pose a = make_pose(full.scene, &arena);
  CHECK(arena.used == need);  // exact
  Pose b = make_pose(full.scene, &arena);
  pose_at(full.scene, 0, 0.7, &a);
  pose_at(full.scene, 1, 0.3, &b);
  pose_at(full.scene, 0, 1.9, &b);
  CHECK(std::memcmp(a.positions.data, b.positions.data, a.positions.bytes()) != 0);
  pose_at(full.scene, 0, 0.7, &b);
  CHECK(arena.used == 2 * need);  // posing allocates nothing
  CHECK(std::memcmp(a.positions.data, b.positions.data, a.positions.bytes()) == 0);
  CHECK(std::memcmp(a.normals.data, b.normals.data, a.normals.bytes()) == 0);
  CHECK(std::memcmp(a.lights.data, b.lights.data, a.lights.bytes()) == 0);
  CHECK(std::memcmp(a.cameras.data, b.cameras.data, a.cameras.bytes()) == 0);
  for (int v = 0; v < 12; ++v) CHECK(a.positions[v] == full.positions[v]);
  pose_at(full.scene, 1, 0.3, &a);  // after animation 0, which sets what animation 1 does not
  arena_release(&arena, need);
  b = make_pose(full.scene, &arena);
  full.scene.animations.data += 1, full.scene.animations.count = 1;
  pose_at(full.scene, 0, 0.3, &b);
  CHECK(std::memcmp(a.positions.data, b.positions.data, a.positions.bytes()) == 0);
  CHECK(std::memcmp(a.weights.data, full.weights.data(), a.weights.bytes()) == 0);
}

// Goal: the same bits on every CPU. Method: hash of the bytes of a pose that uses every interpolation; the value was
// recorded on x86-64.
TEST_CASE("animate_pose_has_the_same_bits_everywhere") {
  FullScene full;
  make_full_scene(6, 20, 5, &full);
  std::vector<std::uint8_t> block(pose_need(full.scene) + 63);
  Arena arena = make_arena("pose", block.data(), block.size());
  Pose pose = make_pose(full.scene, &arena);
  std::uint32_t hash = 0;
  for (double t : {0.1, 0.55, 1.3}) {
    pose_at(full.scene, 0, t, &pose);
    Scene posed;
    posed.positions = pose.positions, posed.normals = pose.normals, posed.lights = pose.lights,
    posed.cameras = pose.cameras;
    hash = hash * 31 + scene_hash(posed);
  }
  CHECK(hash == 3338544391u);
}

// Goal: values beyond the range of coordinates stay finite, and no operation on the way is invalid (∞ − ∞, ∞ · 0).
// Method: 40 nodes that each scale by 1e10; the CPU's flags, if it has them.
TEST_CASE("animate_overflow_stays_within_coordinates") {
  Stage stage;
  stage.full.nodes.assign(40, Node());
  for (std::uint32_t n = 0; n < 40; ++n)
    stage.full.nodes[n].parent = n ? n - 1 : kNone, stage.full.nodes[n].scale = {1e10f, -1e10f, 1e10f};
  stage.full.moving_meshes[0].node = 39;
  stage.full.rest_positions[0] = {-1, 1, 0};
  stage.channel(ChannelPath::translation, Interpolation::step, {0}, {0, 0, 0});
  std::feclearexcept(FE_ALL_EXCEPT);
  stage.start();
#ifdef FE_INVALID
  CHECK(std::fetestexcept(FE_INVALID) == 0);
#endif
  Vec3 p = stage.vertex(0);
  for (int axis = 0; axis < 3; ++axis) CHECK(std::fabs(p[axis]) <= 1e18f);  // NaN fails
  CHECK(is_finite(stage.pose.normals[0]));
}

// Goal: a scene that is not animated costs nothing.
TEST_CASE("animate_static_scene_needs_no_memory") {
  FullScene full;
  make_full_scene(2, 12, 4, &full);
  full.scene.animations = {};
  CHECK(pose_need(full.scene) == 0);
  Arena arena;
  Pose pose = make_pose(full.scene, &arena);
  pose_at(full.scene, 0, 1, &pose);
  CHECK(pose.positions.empty());
  CHECK(pose.lights.empty());
  CHECK(arena.used == 0);
}
