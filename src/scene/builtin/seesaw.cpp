// The animation of [Jevans92] sec. 5 with shapes of our own: in a circus tent a weight drops onto a seesaw and launches
// a worm into the air; 6,000 triangles, 4 lights, 351 frames, static camera. After about 150 frames little moves (table
// 2). Board and weight are rigid, the worm is a skin over a chain of joints. Metres and seconds.
#include "base/check.h"
#include "scene/animate.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/scene_parts.h"
#include "scene/builtin/seesaw_motion.h"
#include "scene/builtin/seesaw_props.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kFrames = 351, kLights = 4;
constexpr float kFramesPerSecond = 30;
constexpr MeshSize kMovingSize = kBoardSize + kWeightSize + kWormSize;
constexpr MeshSize kSize = kTentSize + kMovingSize;
static_assert(kSize.triangles == 6000, "[Jevans92] sec. 5");

enum NodeIndex : std::uint32_t {
  kBoardNode,
  kWeightNode,
  kBodyNode,
  kJointNode,
  kNodeCount = kJointNode + kWormJoints
};
constexpr std::uint32_t kChannelCount = 7 + kWormJoints;
constexpr std::uint32_t kValuesPerFrame = 4 + (3 + 4) + (3 + 4 + 3) + 3 + 4 * kWormJoints;

// A scene with the counts of `seesaw` and no arrays.
Scene outline() {
  Scene scene;
  scene.positions.count = scene.normals.count = kSize.vertices;
  scene.triangles.count = kSize.triangles;
  scene.nodes.count = kNodeCount;
  scene.joints.count = kWormJoints;
  scene.moving_meshes.count = 3;
  scene.animations.count = 1;
  scene.lights.count = kLights;
  scene.cameras.count = 1;
  return scene;
}

// One key per frame for every channel; all channels share the key times.
struct ChannelWriter {
  Array<Channel> channels;
  Array<float> values;
  std::uint32_t channel_count = 0, value_count = 0;
};

Quaternion about_z(float angle) {
  double half = 0.5 * static_cast<double>(angle);
  return {0, 0, static_cast<float>(det_sin(half)), static_cast<float>(det_cos(half))};
}

float* next_channel(ChannelWriter* writer, std::uint32_t node, ChannelPath path) {
  CHECK_LT(writer->channel_count, writer->channels.count);
  CHECK_LT(node, kNodeCount);
  Channel* channel = &writer->channels[writer->channel_count++];
  *channel = {node, 0, kFrames, writer->value_count, path, Interpolation::linear, 0};
  float* values = writer->values.data + writer->value_count;
  writer->value_count += kFrames * (path == ChannelPath::rotation ? 4 : 3);
  CHECK_LE(writer->value_count, writer->values.count);
  return values;
}
void put(float* values, std::uint32_t frame, const Vec3& v) {
  values[3 * frame] = v.x, values[3 * frame + 1] = v.y, values[3 * frame + 2] = v.z;
}
void put(float* values, std::uint32_t frame, const Quaternion& q) {
  values[4 * frame] = q.x, values[4 * frame + 1] = q.y, values[4 * frame + 2] = q.z, values[4 * frame + 3] = q.w;
}

void animate(Arena* arena, Scene* scene) {
  ChannelWriter writer = {arena_array<Channel>(arena, kChannelCount),
                          arena_array<float>(arena, kFrames * kValuesPerFrame)};
  Array<float> times = arena_array<float>(arena, kFrames);
  float* board = next_channel(&writer, kBoardNode, ChannelPath::rotation);
  float* weight = next_channel(&writer, kWeightNode, ChannelPath::translation);
  float* weight_turn = next_channel(&writer, kWeightNode, ChannelPath::rotation);
  float* body = next_channel(&writer, kBodyNode, ChannelPath::translation);
  float* body_turn = next_channel(&writer, kBodyNode, ChannelPath::rotation);
  float* body_scale = next_channel(&writer, kBodyNode, ChannelPath::scale);
  float* tail = next_channel(&writer, kJointNode, ChannelPath::translation);
  float* joints[kWormJoints];
  for (std::uint32_t k = 0; k < kWormJoints; ++k)
    joints[k] = next_channel(&writer, kJointNode + k, ChannelPath::rotation);
  CHECK_EQ(writer.channel_count, kChannelCount);
  CHECK_EQ(writer.value_count, writer.values.count);
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    times[frame] = static_cast<float>(frame) / kFramesPerSecond;
    SeesawState state = seesaw_at(frame / static_cast<double>(kFramesPerSecond));
    put(board, frame, about_z(state.board_angle));
    put(weight, frame, state.weight_position);
    put(weight_turn, frame, about_z(state.weight_angle));
    put(body, frame, state.body_position);
    put(body_turn, frame, about_z(state.body_angle));
    put(body_scale, frame, state.body_scale);
    put(tail, frame, state.tail_offset);
    for (std::uint32_t k = 0; k < kWormJoints; ++k) put(joints[k], frame, about_z(state.joint_angle[k]));
  }
  Array<Animation> animations = default_array<Animation>(arena, 1);
  animations[0] = {0, kChannelCount, kFrames / kFramesPerSecond};
  scene->animations = animations;
  scene->channels = writer.channels;
  scene->key_times = times;
  scene->key_values = writer.values;
}

// Nodes at time 0, and the chain of joints along the worm.
void add_nodes(Arena* arena, Scene* scene) {
  SeesawState state = seesaw_at(0);
  Array<Node> nodes = default_array<Node>(arena, kNodeCount);
  nodes[kBoardNode].translation = {0, kPivotHeight, 0};
  nodes[kBoardNode].rotation = about_z(state.board_angle);
  nodes[kWeightNode].translation = state.weight_position;
  nodes[kWeightNode].rotation = about_z(state.weight_angle);
  nodes[kBodyNode].translation = state.body_position;
  nodes[kBodyNode].rotation = about_z(state.body_angle);
  nodes[kBodyNode].scale = state.body_scale;
  Array<Joint> joints = default_array<Joint>(arena, kWormJoints);
  constexpr float kSegment = kWormLength / kWormJoints;
  for (std::uint32_t k = 0; k < kWormJoints; ++k) {
    Node* node = &nodes[kJointNode + k];
    node->parent = kJointNode + k - 1;  // the first joint is a child of the body
    node->translation = k ? Vec3{0, kSegment, 0} : state.tail_offset;
    node->rotation = about_z(state.joint_angle[k]);
    joints[k].node = kJointNode + k;
    joints[k].inverse_bind.m[1][3] = -kSegment * static_cast<float>(k);
  }
  Array<Skin> skins = default_array<Skin>(arena, 1);
  skins[0] = {0, kWormJoints};
  scene->nodes = nodes;
  scene->joints = joints;
  scene->skins = skins;
}

// A vertex follows its two nearest joints; the head is rigid.
SkinWeight skin_weight(float y) {
  constexpr float kSegment = kWormLength / kWormJoints;
  float head = kWormLength - 2 * kWormHead;
  float along = (y < head ? y : head) / kSegment;
  int low = static_cast<int>(along - 0.5f < 0 ? 0 : along - 0.5f);
  int high = low + 1 < kWormJoints ? low + 1 : low;
  float t = along - 0.5f - static_cast<float>(low);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  if (low == high) t = 0;
  SkinWeight weight = {};
  weight.joint[0] = static_cast<std::uint16_t>(low);
  weight.joint[1] = static_cast<std::uint16_t>(high);
  weight.weight[0] = 1 - t;
  weight.weight[1] = t;
  return weight;
}

void add_moving_meshes(Arena* arena, Scene* scene, std::uint32_t first_vertex) {
  Array<Vec3> rest = arena_array<Vec3>(arena, kMovingSize.vertices);
  Array<Vec3> rest_normals = arena_array<Vec3>(arena, kMovingSize.vertices);
  for (std::uint32_t v = 0; v < kMovingSize.vertices; ++v) {
    rest[v] = scene->positions[first_vertex + v];
    rest_normals[v] = scene->normals[first_vertex + v];
  }
  Array<MovingMesh> meshes = default_array<MovingMesh>(arena, 3);
  const MeshSize sizes[3] = {kBoardSize, kWeightSize, kWormSize};
  std::uint32_t begin = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    meshes[i].vertex_begin = first_vertex + begin;
    meshes[i].vertex_count = sizes[i].vertices;
    meshes[i].rest_begin = begin;
    meshes[i].node = kBoardNode + i;
    begin += sizes[i].vertices;
  }
  CHECK_EQ(begin, kMovingSize.vertices);
  CHECK_LE(first_vertex + begin, scene->positions.count);
  meshes[2].skin = 0;
  Array<SkinWeight> weights = arena_array<SkinWeight>(arena, kWormSize.vertices);
  for (std::uint32_t v = 0; v < kWormSize.vertices; ++v) weights[v] = skin_weight(rest[meshes[2].rest_begin + v].y);
  scene->rest_positions = rest;
  scene->rest_normals = rest_normals;
  scene->moving_meshes = meshes;
  scene->skin_weights = weights;
}

// Scene::positions hold the pose at time 0.
void pose_at_rest(Arena* arena, MeshWriter* mesh, const Scene& scene) {
  std::size_t mark = arena_mark(*arena);
  Pose pose = make_pose(scene, arena);
  pose_at(scene, 0, 0, &pose);
  CHECK_EQ(pose.positions.count, kSize.vertices);
  CHECK_EQ(pose.normals.count, kSize.vertices);
  for (std::uint32_t v = 0; v < kSize.vertices; ++v) {
    mesh->positions[v] = pose.positions[v];
    mesh->normals[v] = pose.normals[v];
  }
  arena_release(arena, mark);
}

void add_materials(Arena* arena, Scene* scene) {
  Array<Material> materials = default_array<Material>(arena, kSeesawMaterialCount);
  materials[kTentRed] = matte({.62f, .06f, .05f});
  materials[kTentCream] = matte({.82f, .72f, .52f});
  materials[kSawdust] = matte({.52f, .36f, .19f});
  materials[kCurbRed] = glossy({.5f, .03f, .04f}, {.05f, .05f, .05f}, 30);
  materials[kGold] = glossy({.78f, .5f, .09f}, {.15f, .12f, .05f}, 25);
  materials[kPoleWood] = glossy({.75f, .7f, .6f}, {.05f, .05f, .05f}, 20);
  materials[kBoardBlue] = glossy({.05f, .16f, .52f}, {.06f, .06f, .06f}, 30);
  materials[kIron] = glossy({.055f, .06f, .07f}, {.22f, .22f, .24f}, 28);
  materials[kWormSkin] = glossy({.33f, .62f, .10f}, {.10f, .11f, .08f}, 35);
  materials[kWormBelly] = glossy({.58f, .72f, .16f}, {.10f, .11f, .08f}, 35);
  materials[kEyeWhite] = glossy({.85f, .85f, .85f}, {.12f, .12f, .12f}, 60);
  materials[kPupil] = glossy({.01f, .01f, .01f}, {.2f, .2f, .2f}, 60);
  materials[kMouth] = matte({.35f, .03f, .05f});
  materials[kHat] = glossy({.42f, .06f, .5f}, {.06f, .06f, .06f}, 20);
  scene->materials = materials;
}

void add_lights(Arena* arena, Scene* scene) {
  Array<Light> lights = default_array<Light>(arena, kLights);
  lights[0] = spot_light({-4, 9, 8}, {.3f, 1.4f, .4f}, {480, 455, 405}, 20, 36);
  lights[1] = spot_light({6, 8.5f, 6}, {0, 1.4f, 0}, {170, 160, 180}, 18, 34);
  lights[2].position = {0, 6.6f, -3};
  lights[2].intensity = {75, 62, 44};
  lights[3].position = {0, 5, 10.5f};
  lights[3].intensity = {85, 80, 74};
  scene->lights = lights;
}

}  // namespace

std::size_t seesaw_need() {
  return mesh_need(kSize) + parts_need(kSeesawMaterialCount, kLights, 1) + arena_need<Channel>(kChannelCount) +
         arena_need<float>(kFrames * kValuesPerFrame) + arena_need<float>(kFrames) + arena_need<Animation>(1) +
         arena_need<Node>(kNodeCount) + arena_need<Joint>(kWormJoints) + arena_need<Skin>(1) +
         2 * arena_need<Vec3>(kMovingSize.vertices) + arena_need<MovingMesh>(3) +
         arena_need<SkinWeight>(kWormSize.vertices) + pose_need(outline());
}

void build_seesaw(Arena* arena, Scene* scene) {
  name_scene(scene, "seesaw");
  MeshWriter mesh = make_mesh(arena, kSize);
  add_tent(&mesh);
  std::uint32_t first_moving = mesh.vertex_count;
  add_board(&mesh);
  add_weight(&mesh);
  add_worm(&mesh);
  finish_mesh(mesh, scene);
  add_materials(arena, scene);
  add_lights(arena, scene);
  scene->info.ambient = {.15f, .128f, .105f};
  scene->info.frame_count = kFrames;
  scene->info.frames_per_second = kFramesPerSecond;
  set_camera(arena, scene, {0, 2.9f, 10.8f}, {0, 2.7f, 0}, 39);
  animate(arena, scene);
  add_nodes(arena, scene);
  add_moving_meshes(arena, scene, first_moving);
  pose_at_rest(arena, &mesh, *scene);
}

}  // namespace pocketray
