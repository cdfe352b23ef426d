// Validates moving content: nodes, animations, skins, moving meshes. Every pass is linear in the size of the file:
// ranges that several elements may share are bounded by kChannelKeyCountMax and kMorphTargetCountMax, and moving meshes
// may not overlap.
#include "base/limit_list.h"
#include "scene/channel.h"
#include "scene/validate_checks.h"

namespace pocketray {
namespace {

bool is_unit(const Quaternion& q) {
  if (!is_coordinate(q.x) || !is_coordinate(q.y) || !is_coordinate(q.z) || !is_coordinate(q.w)) return false;
  float square = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  return square >= 0.98f && square <= 1.02f;
}

Status validate_node(const Scene& scene, std::uint32_t index) {
  const Node& node = scene.nodes[index];
  if (node.parent != kNone && node.parent >= index)
    return failure("nodes[%u] has parent %u: parents must come before their children", index, node.parent);
  if (!is_coordinate(node.translation) || !is_coordinate(node.scale) || !is_unit(node.rotation))
    return failure("nodes[%u] has a translation, rotation or scale that is not finite, or no unit quaternion", index);
  const bool is_hidden = node.scale.x == 0 || node.scale.y == 0 || node.scale.z == 0;  // HARDCASES row 70
  if (!is_hidden && !is_invertible(compose({0, 0, 0}, node.rotation, node.scale)))
    return failure("nodes[%u] has scale %g %g %g, which cannot be inverted", index, static_cast<double>(node.scale.x),
                   static_cast<double>(node.scale.y), static_cast<double>(node.scale.z));
  if (node.weight_count > kMorphTargetCountMax)
    return failure("nodes[%u] has %u morph weights, at most %u are supported", index, node.weight_count,
                   kMorphTargetCountMax);
  if (!is_range(node.weight_begin, node.weight_count, scene.weights.count))
    return failure("nodes[%u] has morph weights beyond the scene's %u", index, scene.weights.count);
  return success();
}

// Numbers of elements that a channel's index may refer to.
struct Targets {
  const char* name;
  std::uint32_t count;
};
Targets targets_of(const Scene& scene, ChannelPath path) {
  if (path <= ChannelPath::visibility) return {"node", scene.nodes.count};
  if (path <= ChannelPath::light_scale) return {"light", scene.lights.count};
  if (path == ChannelPath::camera_size) return {"camera", scene.cameras.count};
  return {"material", scene.materials.count};
}

Status validate_channel(const Scene& scene, std::uint32_t index) {
  const Channel& channel = scene.channels[index];
  if (static_cast<int>(channel.path) >= kChannelPathCount || channel.interpolation > Interpolation::cubic)
    return failure("channels[%u] has an unknown path or interpolation", index);
  const Targets targets = targets_of(scene, channel.path);
  if (channel.node >= targets.count)
    return failure("channels[%u] changes %s %u of %u", index, targets.name, channel.node, targets.count);
  std::uint64_t width = channel_width(scene, channel);
  if (width == 0) return failure("channels[%u] sets morph weights of node %u, which has none", index, channel.node);
  if (channel.key_count < 1 || !is_range(channel.key_begin, channel.key_count, scene.key_times.count))
    return failure("channels[%u] has no keys, or keys beyond the scene's %u", index, scene.key_times.count);
  std::uint64_t floats = channel.key_count * width * (channel.interpolation == Interpolation::cubic ? 3 : 1);
  if (!is_range(channel.value_begin, floats, scene.key_values.count))
    return failure("channels[%u] has values beyond the scene's %u", index, scene.key_values.count);
  const float* times = scene.key_times.data + channel.key_begin;
  if (!(times[0] >= 0)) return failure("channels[%u] starts before time 0", index);
  for (std::uint32_t k = 1; k < channel.key_count; ++k)
    if (!(times[k - 1] < times[k]))
      return failure("channels[%u]: the time of key %u is not after the one before", index, k);
  return success();
}

Status validate_channels(const Scene& scene) {
  std::uint64_t key_count = 0;
  for (const Channel& channel : scene.channels) key_count += channel.key_count;
  if (key_count > kChannelKeyCountMax)
    return failure("%llu animation keys, at most %u are supported: resample the animation",
                   static_cast<unsigned long long>(key_count), kChannelKeyCountMax);
  for (std::uint32_t i = 0; i < scene.channels.count; ++i) RETURN_IF_ERROR(validate_channel(scene, i));
  return success();
}

Status validate_skins(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.joints.count; ++i) {
    const Joint& joint = scene.joints[i];
    if (joint.node >= scene.nodes.count)
      return failure("joints[%u] is node %u of %u", i, joint.node, scene.nodes.count);
    if (!is_coordinate(joint.inverse_bind))
      return failure("joints[%u] has an inverse bind matrix that is not finite", i);
  }
  for (std::uint32_t i = 0; i < scene.skins.count; ++i) {
    const Skin& skin = scene.skins[i];
    if (skin.joint_count < 1 || !is_range(skin.joint_begin, skin.joint_count, scene.joints.count))
      return failure("skins[%u] has no joints, or joints beyond the scene's %u", i, scene.joints.count);
  }
  return success();
}

Status validate_skinned(const Scene& scene, std::uint32_t index) {
  const MovingMesh& mesh = scene.moving_meshes[index];
  if (mesh.skin == kNone) return success();
  if (mesh.skin >= scene.skins.count)
    return failure("moving_meshes[%u] has skin %u of %u", index, mesh.skin, scene.skins.count);
  if (!is_range(mesh.skin_weight_begin, mesh.vertex_count, scene.skin_weights.count))
    return failure("moving_meshes[%u] has skin weights beyond the scene's %u", index, scene.skin_weights.count);
  std::uint32_t joint_count = scene.skins[mesh.skin].joint_count;
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v)
    for (std::uint16_t joint : scene.skin_weights[mesh.skin_weight_begin + v].joint)
      if (joint >= joint_count)
        return failure("skin_weights[%u] has joint %u of %u", mesh.skin_weight_begin + v, joint, joint_count);
  return success();
}

Status validate_morphed(const Scene& scene, std::uint32_t index) {
  const MovingMesh& mesh = scene.moving_meshes[index];
  bool placed_by_skin_alone = mesh.skin != kNone && mesh.morph_count == 0;
  if (mesh.node >= scene.nodes.count && !(placed_by_skin_alone && mesh.node == kNone))
    return failure("moving_meshes[%u] follows node %u of %u", index, mesh.node, scene.nodes.count);
  if (mesh.morph_count == 0) return success();
  if (mesh.morph_count > scene.nodes[mesh.node].weight_count)
    return failure("moving_meshes[%u] has %u morph targets, its node %u weights", index, mesh.morph_count,
                   scene.nodes[mesh.node].weight_count);
  if (!is_range(mesh.morph_begin, std::uint64_t(mesh.morph_count) * mesh.vertex_count, scene.morph_positions.count))
    return failure("moving_meshes[%u] has morph targets beyond the scene's %u deltas", index,
                   scene.morph_positions.count);
  return success();
}

Status validate_skin_weights(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.skin_weights.count; ++i) {
    const float* w = scene.skin_weights[i].weight;
    bool each = w[0] >= 0 && w[1] >= 0 && w[2] >= 0 && w[3] >= 0;
    float sum = w[0] + w[1] + w[2] + w[3];
    if (!each || !(sum >= 0.999f && sum <= 1.001f))
      return failure("skin_weights[%u] must be four weights that sum to 1", i);
  }
  return success();
}

Status validate_moving_mesh_arrays(const Scene& scene) {
  RETURN_IF_ERROR(check_coordinates("rest_positions", scene.rest_positions));
  RETURN_IF_ERROR(check_normals("rest_normals", scene.rest_normals));
  RETURN_IF_ERROR(check_coordinates("morph_positions", scene.morph_positions));
  RETURN_IF_ERROR(check_coordinates("morph_normals", scene.morph_normals));
  std::uint32_t rest_normals = scene.normals.empty() ? 0 : scene.rest_positions.count;
  if (!scene.moving_meshes.empty() && scene.rest_normals.count != rest_normals)
    return failure(
        "%u rest_normals for %u rest_positions: there must be one for each if the scene has normals, else none",
        scene.rest_normals.count, scene.rest_positions.count);
  if (scene.morph_normals.count && scene.morph_normals.count != scene.morph_positions.count)
    return failure("%u morph_normals for %u morph_positions: there must be one for each or none",
                   scene.morph_normals.count, scene.morph_positions.count);
  return validate_skin_weights(scene);
}

}  // namespace

Status validate_nodes(const Scene& scene) {
  RETURN_IF_ERROR(check_coordinates("weights", scene.weights));
  for (std::uint32_t i = 0; i < scene.nodes.count; ++i) RETURN_IF_ERROR(validate_node(scene, i));
  if (scene.node_visible.count && scene.node_visible.count != scene.nodes.count)
    return failure("%u node_visible for %u nodes: there must be one for each or none", scene.node_visible.count,
                   scene.nodes.count);
  for (std::uint32_t i = 0; i < scene.node_visible.count; ++i)
    if (scene.node_visible[i] > 1) return failure("node_visible[%u] is %u, not 0 or 1", i, scene.node_visible[i]);
  return success();
}

Status validate_animations(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.key_times.count; ++i)
    if (!within(Quantity::seconds, scene.key_times[i]))
      return failure("key_times[%u] is not a number of seconds or beyond %g: shorten the animation", i, kSecondsMax);
  RETURN_IF_ERROR(check_coordinates("key_values", scene.key_values));
  RETURN_IF_ERROR(validate_channels(scene));
  for (std::uint32_t i = 0; i < scene.animations.count; ++i) {
    const Animation& animation = scene.animations[i];
    if (!is_range(animation.channel_begin, animation.channel_count, scene.channels.count))
      return failure("animations[%u] has channels beyond the scene's %u", i, scene.channels.count);
    if (!within(Quantity::seconds, animation.duration) || animation.duration < 0)
      return failure("animations[%u] has a duration that is negative, beyond %g seconds or not finite", i, kSecondsMax);
  }
  if (scene.animation_labels.count && scene.animation_labels.count != scene.animations.count)
    return failure("%u animation_labels for %u animations: there must be one for each or none",
                   scene.animation_labels.count, scene.animations.count);
  for (std::uint32_t i = 0; i < scene.animation_labels.count; ++i)
    if (scene.animation_labels[i].combines > 1) return failure("animation_labels[%u] is neither kind", i);
  return success();
}

Status validate_moving_meshes(const Scene& scene) {
  RETURN_IF_ERROR(validate_moving_mesh_arrays(scene));
  RETURN_IF_ERROR(validate_skins(scene));
  std::uint64_t end = 0;  // of the runs so far
  for (std::uint32_t i = 0; i < scene.moving_meshes.count; ++i) {
    const MovingMesh& mesh = scene.moving_meshes[i];
    if (mesh.vertex_begin < end || !is_range(mesh.vertex_begin, mesh.vertex_count, scene.positions.count))
      return failure("moving_meshes[%u] overlaps the one before or extends beyond the scene's %u vertices", i,
                     scene.positions.count);
    end = std::uint64_t(mesh.vertex_begin) + mesh.vertex_count;
    if (!is_range(mesh.rest_begin, mesh.vertex_count, scene.rest_positions.count))
      return failure("moving_meshes[%u] extends beyond the scene's %u rest_positions", i, scene.rest_positions.count);
    if (!is_coordinate(mesh.instance) || !is_invertible(mesh.instance))
      return failure("moving_meshes[%u] has an instance transform that is not finite or flattens it", i);
    RETURN_IF_ERROR(validate_skinned(scene, i));
    RETURN_IF_ERROR(validate_morphed(scene, i));
  }
  return success();
}

}  // namespace pocketray
