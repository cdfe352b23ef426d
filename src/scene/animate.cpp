#include "scene/animate.h"

#include <cmath>
#include <cstring>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limit_list.h"
#include "base/limits.h"
#include "scene/channel.h"

namespace pocketray {
namespace {

// Keeps poses within the range of coordinates, so that the product of two values is finite.
float hold(float x) {
  if (std::fabs(x) <= kCoordinateMax) return x;
  return x > 0 ? kCoordinateMax : x < 0 ? -kCoordinateMax : 0.0f;
}
Transform hold(Transform t) {
  for (auto& row : t.m)
    for (float& x : row) x = hold(x);
  return t;
}
Vec3 hold(const Vec3& p) { return {hold(p.x), hold(p.y), hold(p.z)}; }

bool moves_vertices(const Scene& scene) { return is_animated(scene) && scene.moving_meshes.count > 0; }
std::uint32_t posed_normal_count(const Scene& scene) { return moves_vertices(scene) ? scene.normals.count : 0; }
std::uint32_t posed_material_count(const Scene& scene) { return animates_materials(scene) ? scene.materials.count : 0; }
std::uint32_t posed_position_count(const Scene& scene) { return moves_vertices(scene) ? scene.positions.count : 0; }

template <class T>
void copy(Array<const T> from, Array<T> to) {
  CHECK(to.empty() || from.count == to.count);
  if (to.count) std::memcpy(static_cast<void*>(to.data), from.data, to.bytes());
}

// Clamps to the limits of the channel's target: a spline may overshoot.
float limited(double value, double low, double high) {
  return static_cast<float>(value > low ? value < high ? value : high : low);
}
Vec3 limited(const Vec3& v, double high) {
  return {limited(v.x, 0, high), limited(v.y, 0, high), limited(v.z, 0, high)};
}

void set_camera_size(float value, Camera* camera) {
  const bool is_flat = camera->projection == Projection::orthographic;
  const LimitRow& limit = limit_of(is_flat ? Quantity::vertical_extent : Quantity::field_of_view);
  (is_flat ? camera->vertical_extent : camera->vertical_fov) =
      limited(static_cast<double>(value), limit.low, limit.high);
}

// Applies channels of lights, cameras and materials.
void apply_value(const Scene& scene, const Channel& channel, double time, Pose* pose) {
  constexpr double kMost = static_cast<double>(kRadianceMax);
  float value[3];
  channel_value(scene, channel, time, channel_width(scene, channel), value);
  const Vec3 color = {value[0], value[1], value[2]};
  switch (channel.path) {
    case ChannelPath::light_intensity:
      pose->lights[channel.node].intensity = limited(color, kMost);
      break;
    case ChannelPath::light_scale:
      pose->lights[channel.node].intensity = limited(pose->lights[channel.node].intensity * value[0], kMost);
      break;
    case ChannelPath::camera_size:
      set_camera_size(value[0], &pose->cameras[channel.node]);
      break;
    case ChannelPath::material_diffuse:
      pose->materials[channel.node].diffuse = limited(color, 1);
      break;
    case ChannelPath::material_emission:
      pose->materials[channel.node].emission = limited(color, kMost);
      break;
    default:
      CHECK(!"a channel of a node");
  }
}

void apply_channel(const Scene& scene, const Channel& channel, double time, Pose* pose) {
  if (channel.path > ChannelPath::visibility) return apply_value(scene, channel, time, pose);
  Node* node = &pose->local_nodes[channel.node];
  float shown;
  switch (channel.path) {
    case ChannelPath::translation:
      channel_value(scene, channel, time, 3, &node->translation.x);
      break;
    case ChannelPath::rotation:
      node->rotation = channel_rotation(scene, channel, time);
      break;
    case ChannelPath::scale:
      channel_value(scene, channel, time, 3, &node->scale.x);
      break;
    case ChannelPath::weights:
      channel_value(scene, channel, time, node->weight_count, &pose->weights[node->weight_begin]);
      break;
    default:
      channel_value(scene, channel, time, 1, &shown);
      pose->visible[channel.node] = shown >= 0.5f;
  }
}

void rest(const Scene& scene, Pose* pose) {
  CHECK_EQ(pose->local_nodes.count, scene.nodes.count);
  CHECK_EQ(pose->weights.count, scene.weights.count);
  copy(scene.nodes, pose->local_nodes);
  copy(scene.weights, pose->weights);
  copy(scene.lights, pose->lights);
  copy(scene.cameras, pose->cameras);
  if (pose->materials.count) copy(scene.materials, pose->materials);
  for (std::uint32_t n = 0; n < scene.nodes.count; ++n)
    pose->visible[n] = scene.node_visible.empty() || scene.node_visible[n] != 0;
}

Transform shrunk(Transform t) {
  for (auto& row : t.m) row[0] = row[1] = row[2] = 0;
  return t;
}

void place_nodes(const Scene& scene, Pose* pose) {
  CHECK_EQ(pose->joints.count, scene.joints.count);
  CHECK_EQ(pose->visible.count, scene.nodes.count);
  for (std::uint32_t n = 0; n < scene.nodes.count; ++n) {
    const Node& node = pose->local_nodes[n];
    bool overridden = pose->overrides.count && pose->overrides[n].on;
    Transform local = overridden ? pose->overrides[n].to_parent : compose(node.translation, node.rotation, node.scale);
    const bool is_flat = !overridden && (node.scale.x == 0 || node.scale.y == 0 || node.scale.z == 0);
    if (is_flat || !pose->visible[n]) local = shrunk(local);
    if (node.parent != kNone) pose->visible[n] = pose->visible[n] && pose->visible[node.parent];
    pose->nodes[n] = hold(node.parent == kNone ? local : pose->nodes[node.parent] * hold(local));
  }
  for (std::uint32_t j = 0; j < scene.joints.count; ++j)
    pose->joints[j] = hold(pose->nodes[scene.joints[j].node] * scene.joints[j].inverse_bind);
}

// base + Σ weight · delta over the morph targets of vertex `v` [glTF 2.0, sec. 3.7.2.2].
Vec3 morphed(const MovingMesh& mesh, const float* weights, Array<const Vec3> deltas, std::uint32_t v, Vec3 base) {
  for (std::uint32_t target = 0; target < mesh.morph_count; ++target) {
    if (weights[target] == 0) continue;
    base += deltas[mesh.morph_begin + std::size_t(target) * mesh.vertex_count + v] * weights[target];
  }
  return base;
}

// Σ weight · joint matrix [glTF 2.0, sec. 3.7.3.3].
Transform blended(const Transform* joints, const SkinWeight& skin_weight) {
  Transform sum = {{{0}}};
  for (int k = 0; k < 4; ++k) {
    float weight = skin_weight.weight[k];
    if (weight == 0) continue;
    const Transform& joint = joints[skin_weight.joint[k]];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) sum.m[i][j] += weight * joint.m[i][j];
  }
  return sum;
}

bool is_identity(const Transform& t) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      if (t.m[i][j] != (i == j ? 1.0f : 0.0f)) return false;
  return true;
}

// A mesh that nothing moved and whose rest pose equals its place in the world keeps its bits: its normals are not
// normalised a second time.
bool stays_at_rest(const Scene& scene, const MovingMesh& mesh, const Transform& placed) {
  return scene.rest_positions.data == scene.positions.data && mesh.rest_begin == mesh.vertex_begin &&
         mesh.skin == kNone && mesh.morph_count == 0 && is_identity(placed);
}

void rest_mesh(const Scene& scene, const MovingMesh& mesh, Pose* pose) {
  std::uint32_t begin = mesh.vertex_begin, count = mesh.vertex_count;
  copy(Array<const Vec3>{scene.positions.data + begin, count}, Array<Vec3>{pose->positions.data + begin, count});
  if (pose->normals.count)
    copy(Array<const Vec3>{scene.normals.data + begin, count}, Array<Vec3>{pose->normals.data + begin, count});
}

void place_mesh(const Scene& scene, const MovingMesh& mesh, Pose* pose) {
  CHECK_LE(std::uint64_t(mesh.vertex_begin) + mesh.vertex_count, pose->positions.count);
  CHECK_LE(std::uint64_t(mesh.rest_begin) + mesh.vertex_count, scene.rest_positions.count);
  bool with_normals = pose->normals.count > 0;
  bool skinned = mesh.skin != kNone;
  CHECK(skinned ? mesh.skin < scene.skins.count : mesh.node < pose->nodes.count);
  const float* weights = mesh.morph_count ? pose->weights.data + pose->local_nodes[mesh.node].weight_begin : nullptr;
  const Transform* joints = skinned ? pose->joints.data + scene.skins[mesh.skin].joint_begin : nullptr;
  Transform placed;
  const bool is_hidden = skinned && mesh.node != kNone && !pose->visible[mesh.node];
  if (!skinned) placed = hold(pose->nodes[mesh.node] * mesh.instance);
  if (stays_at_rest(scene, mesh, placed)) return rest_mesh(scene, mesh, pose);
  NormalTransform placed_normal = normal_transform(placed);
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    if (skinned) {
      placed = is_hidden ? shrunk(joints[0]) : blended(joints, scene.skin_weights[mesh.skin_weight_begin + v]);
      if (with_normals) placed_normal = normal_transform(placed);
    }
    Vec3 rest = morphed(mesh, weights, scene.morph_positions, v, scene.rest_positions[mesh.rest_begin + v]);
    pose->positions[mesh.vertex_begin + v] = hold(transform_point(placed, hold(rest)));
    if (!with_normals) continue;
    Vec3 normal = scene.rest_normals[mesh.rest_begin + v];
    if (scene.morph_normals.count) normal = morphed(mesh, weights, scene.morph_normals, v, normal);
    pose->normals[mesh.vertex_begin + v] = transform_normal(placed_normal, normal);
  }
}

void place_lights_and_cameras(const Scene& scene, Pose* pose) {
  CHECK_EQ(pose->lights.count, scene.lights.count);
  CHECK_EQ(pose->cameras.count, scene.cameras.count);
  for (std::uint32_t i = 0; i < scene.lights.count; ++i) {
    Light light = pose->lights[i];
    if (light.node != kNone && !pose->visible[light.node]) light.intensity = {0, 0, 0};
    if (light.node != kNone) {
      const Transform& world = pose->nodes[light.node];
      light.position = hold(transform_point(world, light.position));
      Vec3 direction = normalize(transform_vector(world, light.direction));
      if (!is_zero(direction)) light.direction = direction;
      light.node = kNone;
    }
    pose->lights[i] = light;
  }
  for (std::uint32_t i = 0; i < scene.cameras.count; ++i) {
    Camera camera = pose->cameras[i];
    if (camera.node != kNone) {
      const Transform& world = pose->nodes[camera.node];
      camera.eye = hold(transform_point(world, camera.eye));
      camera.target = hold(transform_point(world, camera.target));
      camera.up = hold(transform_vector(world, camera.up));
      if (is_zero(cross(camera.target - camera.eye, camera.up))) {  // below a node without volume: not turned
        const Camera& own = pose->cameras[i];
        camera.target = hold(camera.eye + (own.target - own.eye)), camera.up = own.up;
      }
      camera.node = kNone;
    }
    pose->cameras[i] = camera;
  }
}

double wrapped(double seconds, double duration) {
  if (!(duration > 0)) return 0;
  double time = std::fmod(seconds, duration);  // exact
  if (time < 0) time += duration;
  return time < duration ? time : 0;  // a tiny negative time rounds up to the duration; NaN also ends here
}

}  // namespace

bool animates_materials(const Scene& scene) {
  for (const Channel& channel : scene.channels)
    if (channel.path >= ChannelPath::material_diffuse) return true;
  return false;
}

std::size_t pose_need(const Scene& scene) {
  if (!is_animated(scene)) return 0;
  const std::size_t parts[] = {
      arena_need<Vec3>(posed_position_count(scene)), arena_need<Vec3>(posed_normal_count(scene)),
      arena_need<Transform>(scene.nodes.count),      arena_need<Light>(scene.lights.count),
      arena_need<Camera>(scene.cameras.count),       arena_need<Node>(scene.nodes.count),
      arena_need<float>(scene.weights.count),        arena_need<Transform>(scene.joints.count),
      arena_need<std::uint8_t>(scene.nodes.count),   arena_need<Material>(posed_material_count(scene))};
  std::size_t sum = 0;
  for (std::size_t part : parts) sum = size_sum(sum, part);
  return sum;
}

Pose make_pose(const Scene& scene, Arena* arena) {
  Pose pose;
  if (!is_animated(scene)) return pose;
  std::size_t used = arena->used;
  pose.positions = arena_array<Vec3>(arena, posed_position_count(scene));
  pose.normals = arena_array<Vec3>(arena, posed_normal_count(scene));
  pose.nodes = arena_array<Transform>(arena, scene.nodes.count);
  pose.lights = arena_array<Light>(arena, scene.lights.count);
  pose.cameras = arena_array<Camera>(arena, scene.cameras.count);
  pose.local_nodes = arena_array<Node>(arena, scene.nodes.count);
  pose.weights = arena_array<float>(arena, scene.weights.count);
  pose.joints = arena_array<Transform>(arena, scene.joints.count);
  pose.visible = arena_array<std::uint8_t>(arena, scene.nodes.count);
  pose.materials = arena_array<Material>(arena, posed_material_count(scene));
  CHECK_EQ(arena->used - used, pose_need(scene));
  copy(scene.positions, pose.positions);
  copy(scene.normals, pose.normals);
  pose_at(scene, 0, 0, &pose);
  return pose;
}

void pose_at(const Scene& scene, std::uint32_t animation_index, double seconds, Pose* pose) {
  if (!is_animated(scene)) return;
  CHECK(animation_index == kNone || animation_index < scene.animations.count);
  CHECK_EQ(pose->nodes.count, scene.nodes.count);
  CHECK(pose->overrides.empty() || pose->overrides.count == scene.nodes.count);
  rest(scene, pose);
  const Animation still = {0, 0, 0}, &animation = animation_index == kNone ? still : scene.animations[animation_index];
  CHECK_LE(std::uint64_t(animation.channel_begin) + animation.channel_count, scene.channels.count);
  const double time = wrapped(seconds, animation.duration);
  for (std::uint32_t c = 0; c < animation.channel_count; ++c)
    apply_channel(scene, scene.channels[animation.channel_begin + c], time, pose);
  place_nodes(scene, pose);
  for (const MovingMesh& mesh : scene.moving_meshes) place_mesh(scene, mesh, pose);
  place_lights_and_cameras(scene, pose);
}

}  // namespace pocketray
