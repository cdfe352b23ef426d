// The nodes that animations move (sec. 3.11), and hidden nodes.
#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

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

// Converts a root's translation to the scene's coordinates.
Vec3 root_translation(const GltfFile& file, const GltfNode& node) {
  const Vec3d origin = origin_of(*file.builder);
  Vec3 t;
  for (int c = 0; c < 3; ++c) t[c] = static_cast<float>(node.local_exactly.m[c][3] - origin[c]);
  return t;
}

void export_node(GltfFile* file, int index) {
  SceneArrays& out = *file->builder->out;
  GltfNode& state = file->nodes[static_cast<std::size_t>(index)];
  const bool is_flat = determinant(state.local) == 0;
  if (!is_flat) require_invertible(state.local, gltf_node_name(*file, index));
  const tinygltf::Node& source = file->model.nodes[static_cast<std::size_t>(index)];
  Node node;
  if (source.matrix.empty())
    node = gltf_node_trs(*file, index);
  else if (is_flat)
    node.translation = column(state.local, 3), node.scale = {0, 0, 0};
  else
    node = decomposed(file, state.local);
  if (state.parent >= 0) node.parent = file->nodes[static_cast<std::size_t>(state.parent)].out_node;
  if (state.parent < 0 && !out.origin.empty()) node.translation = root_translation(*file, state);
  node.weight_begin = static_cast<std::uint32_t>(out.weights.size());
  if (state.weights_move) {
    node.weight_count = gltf_morph_target_count(*file, index);
    std::vector<float> weights = gltf_morph_weights(*file, index, node.weight_count);
    out.weights.insert(out.weights.end(), weights.begin(), weights.end());
  }
  state.out_node = static_cast<std::uint32_t>(out.nodes.size());
  out.nodes.push_back(node);
  out.node_visible.push_back(state.visible);
}

void note_hidden(GltfFile* file, int count, int first) {
  if (count == 0) return;
  const std::string name = gltf_node_name(*file, first);
  note_remark(file->builder,
              name + (count == 1 ? " is hidden by its scale of 0"
                                 : " and " + std::to_string(count - 1) + " more nodes are hidden by their scale of 0"));
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

std::uint32_t gltf_morph_target_count(const GltfFile& file, int node) {
  int mesh = file.model.nodes[static_cast<std::size_t>(node)].mesh;
  std::size_t count = 0;
  if (mesh >= 0 && static_cast<std::size_t>(mesh) < file.model.meshes.size())
    for (const tinygltf::Primitive& primitive : file.model.meshes[static_cast<std::size_t>(mesh)].primitives)
      count = std::max(count, primitive.targets.size());
  return static_cast<std::uint32_t>(std::min<std::size_t>(count, kMorphTargetCountMax));
}

void gltf_mark_movers(GltfFile* file) {
  for (const GltfDrive& drive : file->drives) {
    if (drive.target.path > ChannelPath::visibility) continue;
    GltfNode& node = file->nodes[static_cast<std::size_t>(drive.target.index)];
    node.mover = drive.target.index;
    (drive.target.path == ChannelPath::weights ? node.weights_move : node.moves) = true;
    node.scale_moves |= drive.target.path == ChannelPath::scale;
    node.visibility_moves |= drive.target.path == ChannelPath::visibility;
  }
  int hidden_count = 0, first_hidden = -1;
  for (int index : file->order) {
    GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
    static const GltfNode kNoParent;
    const GltfNode& parent = node.parent < 0 ? kNoParent : file->nodes[static_cast<std::size_t>(node.parent)];
    const bool is_flat = determinant(node.local) == 0, stays_flat = is_flat && !node.scale_moves;
    node.flat = parent.flat || is_flat;
    node.unseen = parent.unseen || (!node.visible && !node.visibility_moves);
    node.hidden = parent.hidden || node.unseen || stays_flat;
    if (stays_flat && !parent.hidden && hidden_count++ == 0) first_hidden = index;
    node.moves |= parent.moves, node.visibility_moves |= parent.visibility_moves;
    if (node.mover < 0) node.mover = parent.mover;
  }
  note_hidden(file, hidden_count, first_hidden);
}

void gltf_export_nodes(GltfFile* file) {
  // Exports nodes with a channel, and joints, with all their ancestors.
  for (auto index = file->order.rbegin(); index != file->order.rend(); ++index) {
    GltfNode& node = file->nodes[static_cast<std::size_t>(*index)];
    node.exported |= node.mover == *index;
    if (node.exported && node.parent >= 0) file->nodes[static_cast<std::size_t>(node.parent)].exported = true;
  }
  for (int index : file->order)
    if (file->nodes[static_cast<std::size_t>(index)].exported) export_node(file, index);
  std::vector<std::uint8_t>& visible = file->builder->out->node_visible;
  if (std::find(visible.begin(), visible.end(), 0) == visible.end()) visible.clear();
}

}  // namespace pocketray
