// Animations (sec. 3.11) and the nodes they move.
#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "import/gltf.h"
#include "import/import_error.h"

namespace pocketray {
namespace {

constexpr float kFramesPerSecond = 30;  // glTF has keys, not frames

// False for targets that are not animated here, or not part of the scene.
bool target_path(const GltfFile& file, const tinygltf::AnimationChannel& channel, ChannelPath* path) {
  const char* const names[] = {"translation", "rotation", "scale", "weights"};
  auto found = std::find(std::begin(names), std::end(names), channel.target_path);
  if (found == std::end(names) || channel.target_node < 0) return false;
  std::size_t node = static_cast<std::size_t>(channel.target_node);
  if (node >= file.nodes.size())
    fail_import("an animation moves node %zu, which does not exist; export the file again", node);
  *path = static_cast<ChannelPath>(found - std::begin(names));
  return file.nodes[node].visited;
}

std::uint32_t morph_target_count(const GltfFile& file, int node) {
  int mesh = file.model.nodes[static_cast<std::size_t>(node)].mesh;
  std::size_t count = 0;
  if (mesh >= 0 && static_cast<std::size_t>(mesh) < file.model.meshes.size())
    for (const tinygltf::Primitive& primitive : file.model.meshes[static_cast<std::size_t>(mesh)].primitives)
      count = std::max(count, primitive.targets.size());
  return static_cast<std::uint32_t>(std::min<std::size_t>(count, kMorphTargetCountMax));
}

// Key times and values of a sampler as they go into the scene. Empty times: the channel cannot be used.
struct Keys {
  std::vector<float> times, values;
  Interpolation interpolation = Interpolation::linear;
};

bool are_sound(const Keys& keys, std::size_t width) {
  for (std::size_t i = 0; i < keys.times.size(); ++i)
    if (keys.times[i] < 0 || (i > 0 && keys.times[i - 1] >= keys.times[i])) return false;
  std::size_t per_key = width * (keys.interpolation == Interpolation::cubic ? 3 : 1);
  return !keys.times.empty() && width > 0 && keys.values.size() == keys.times.size() * per_key;
}

Keys read_keys(GltfFile* file, const tinygltf::Animation& animation, int sampler_index, ChannelPath path) {
  if (sampler_index < 0 || static_cast<std::size_t>(sampler_index) >= animation.samplers.size())
    fail_import("animation sampler %d does not exist; export the file again", sampler_index);
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(sampler_index)];
  Keys keys;
  if (sampler.interpolation == "STEP") keys.interpolation = Interpolation::step;
  if (sampler.interpolation == "CUBICSPLINE") keys.interpolation = Interpolation::cubic;
  keys.times = gltf_floats(file, sampler.input, 1, "animation times");
  int components = path == ChannelPath::rotation ? 4 : path == ChannelPath::weights ? 1 : 3;
  keys.values = gltf_floats(file, sampler.output, components, "animation values");
  return keys;
}

void export_channel(GltfFile* file, const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source) {
  SceneArrays& out = *file->builder->out;
  Channel channel = {};
  if (!target_path(*file, source, &channel.path))
    return note_unused(file->builder, "animation of nodes outside the scene");
  channel.node = file->nodes[static_cast<std::size_t>(source.target_node)].out_node;
  if (channel.node == kNone) return note_unused(file->builder, "animation of morph weights without targets");
  std::size_t width = channel.path == ChannelPath::rotation ? 4 : 3;
  if (channel.path == ChannelPath::weights) width = out.nodes[channel.node].weight_count;
  Keys keys = read_keys(file, animation, source.sampler, channel.path);
  if (!are_sound(keys, width))
    return note_remark(file->builder, "an animation channel is skipped: its keys are unordered or too few");
  charge_bytes(file->builder, (keys.times.size() + keys.values.size()) * sizeof(float), "the animation");
  channel.interpolation = keys.interpolation;
  channel.key_count = static_cast<std::uint32_t>(keys.times.size());
  // Channels of one animation mostly share their times.
  bool same = out.key_times.size() >= keys.times.size() &&
              std::equal(keys.times.begin(), keys.times.end(),
                         out.key_times.end() - static_cast<std::ptrdiff_t>(keys.times.size()));
  if (!same) out.key_times.insert(out.key_times.end(), keys.times.begin(), keys.times.end());
  channel.key_begin = static_cast<std::uint32_t>(out.key_times.size() - keys.times.size());
  channel.value_begin = static_cast<std::uint32_t>(out.key_values.size());
  out.key_values.insert(out.key_values.end(), keys.values.begin(), keys.values.end());
  out.animations.back().duration = std::max(out.animations.back().duration, keys.times.back());
  out.channels.push_back(channel);
  ++out.animations.back().channel_count;
}

Vec3 column(const Transform& t, int c) { return {t.m[0][c], t.m[1][c], t.m[2][c]}; }

// Rotation matrix → quaternion [Shepperd 1978].
Quaternion quaternion_of(const Vec3& x, const Vec3& y, const Vec3& z) {
  double m[3][3] = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
  double q[4], trace = m[0][0] + m[1][1] + m[2][2];
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (m[i][i] > m[k][k]) k = i;
  if (trace > m[k][k]) {
    q[3] = 1 + trace;
    q[0] = m[2][1] - m[1][2], q[1] = m[0][2] - m[2][0], q[2] = m[1][0] - m[0][1];
  } else {
    int i = k, j = (k + 1) % 3, l = (k + 2) % 3;
    q[i] = 1 + m[i][i] - m[j][j] - m[l][l];
    q[j] = m[j][i] + m[i][j], q[l] = m[l][i] + m[i][l], q[3] = m[l][j] - m[j][l];
  }
  double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {static_cast<float>(q[0] / n), static_cast<float>(q[1] / n), static_cast<float>(q[2] / n),
          static_cast<float>(q[3] / n)};
}

// Decomposes a matrix into translation, rotation and scale; shear is lost, with a remark.
Node decomposed(GltfFile* file, const Transform& t) {
  Node node;
  node.translation = column(t, 3);
  for (int c = 0; c < 3; ++c) node.scale[c] = length(column(t, c));
  if (determinant(t) < 0) node.scale.x = -node.scale.x;
  Vec3 axis[3];
  for (int c = 0; c < 3; ++c) axis[c] = column(t, c) / node.scale[c];
  node.rotation = quaternion_of(axis[0], axis[1], axis[2]);
  float shear = std::fmax(std::fabs(dot(axis[0], axis[1])),
                          std::fmax(std::fabs(dot(axis[1], axis[2])), std::fabs(dot(axis[2], axis[0]))));
  if (shear > 1e-3f) note_remark(file->builder, "shear above an animated node is ignored");
  return node;
}

void export_node(GltfFile* file, int index) {
  SceneArrays& out = *file->builder->out;
  GltfNode& state = file->nodes[static_cast<std::size_t>(index)];
  require_invertible(state.local, gltf_node_name(*file, index));
  const tinygltf::Node& source = file->model.nodes[static_cast<std::size_t>(index)];
  Node node = source.matrix.empty() ? gltf_node_trs(*file, index) : decomposed(file, state.local);
  if (state.parent >= 0) node.parent = file->nodes[static_cast<std::size_t>(state.parent)].out_node;
  node.weight_begin = static_cast<std::uint32_t>(out.weights.size());
  if (state.weights_move) {
    node.weight_count = morph_target_count(*file, index);
    std::vector<float> weights = gltf_morph_weights(*file, index, node.weight_count);
    out.weights.insert(out.weights.end(), weights.begin(), weights.end());
  }
  state.out_node = static_cast<std::uint32_t>(out.nodes.size());
  out.nodes.push_back(node);
}

}  // namespace

std::vector<float> gltf_morph_weights(const GltfFile& file, int index, std::size_t count) {
  const tinygltf::Node& node = file.model.nodes[static_cast<std::size_t>(index)];
  const std::vector<double>* source = &node.weights;
  if (source->empty() && node.mesh >= 0 && static_cast<std::size_t>(node.mesh) < file.model.meshes.size())
    source = &file.model.meshes[static_cast<std::size_t>(node.mesh)].weights;
  std::vector<float> weights(count, 0.0f);
  for (std::size_t i = 0; i < std::min(count, source->size()); ++i)
    weights[i] = std::fabs((*source)[i]) <= 1e18 ? static_cast<float>((*source)[i]) : 0.0f;
  return weights;
}

void gltf_mark_movers(GltfFile* file) {
  for (const tinygltf::Animation& animation : file->model.animations)
    for (const tinygltf::AnimationChannel& channel : animation.channels) {
      ChannelPath path;
      if (!target_path(*file, channel, &path)) continue;
      GltfNode& node = file->nodes[static_cast<std::size_t>(channel.target_node)];
      bool weights = path == ChannelPath::weights;
      if (weights && morph_target_count(*file, channel.target_node) == 0) continue;
      node.mover = channel.target_node;
      (weights ? node.weights_move : node.moves) = true;
    }
  for (int index : file->order) {
    GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
    if (node.parent < 0) continue;
    const GltfNode& parent = file->nodes[static_cast<std::size_t>(node.parent)];
    node.moves |= parent.moves;
    if (node.mover < 0) node.mover = parent.mover;
  }
}

void gltf_export_nodes(GltfFile* file) {
  // Nodes with a channel, and joints, with all their ancestors.
  for (auto index = file->order.rbegin(); index != file->order.rend(); ++index) {
    GltfNode& node = file->nodes[static_cast<std::size_t>(*index)];
    node.exported |= node.mover == *index;
    if (node.exported && node.parent >= 0) file->nodes[static_cast<std::size_t>(node.parent)].exported = true;
  }
  for (int index : file->order)
    if (file->nodes[static_cast<std::size_t>(index)].exported) export_node(file, index);
}

void gltf_export_animations(GltfFile* file) {
  SceneArrays& out = *file->builder->out;
  if (out.nodes.empty()) return;
  for (const tinygltf::Animation& source : file->model.animations) {
    out.animations.push_back({static_cast<std::uint32_t>(out.channels.size()), 0, 0});
    for (const tinygltf::AnimationChannel& channel : source.channels) export_channel(file, source, channel);
  }
  out.info.frames_per_second = kFramesPerSecond;
  double frames = static_cast<double>(out.animations[0].duration) * static_cast<double>(kFramesPerSecond);
  out.info.frame_count = static_cast<std::uint32_t>(std::min(std::max(frames + 0.5, 1.0), 1e6));
}

}  // namespace pocketray
