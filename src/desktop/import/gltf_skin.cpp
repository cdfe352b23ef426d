// Skins (sec. 3.7.3), and meshes posed once because their skin or morph weights never move.
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

const tinygltf::Skin& skin_at(const GltfFile& file, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= file.model.skins.size())
    fail_import("skin %d does not exist; export the file again", index);
  return file.model.skins[static_cast<std::size_t>(index)];
}

std::vector<Transform> inverse_binds(GltfFile* file, const tinygltf::Skin& skin) {
  std::vector<Transform> result(skin.joints.size());
  if (skin.inverseBindMatrices < 0) return result;
  std::vector<float> values = gltf_floats(file, skin.inverseBindMatrices, 16, "inverse bind matrices");
  if (values.size() / 16 < result.size())
    fail_import("a skin has %zu joints, but %zu inverse bind matrices; export the file again", result.size(),
                values.size() / 16);
  for (std::size_t j = 0; j < result.size(); ++j)
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column) result[j].m[row][column] = values[16 * j + 4 * column + row];
  return result;
}

// A joint without volume gives none to the vertices that follow it (HARDCASES row 70).
Transform joint_world(const GltfNode& joint) {
  Transform world = joint.world;
  if (joint.flat || joint.unseen)
    for (auto& row : world.m) row[0] = row[1] = row[2] = 0;
  return world;
}

// Σ weight · joint matrix (sec. 3.7.3.3).
Transform blended(const std::vector<Transform>& joints, const SkinWeight& weight) {
  Transform sum = {{{0}}};
  for (int k = 0; k < 4; ++k)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        sum.m[row][column] += weight.weight[k] * joints[weight.joint[k]].m[row][column];
  return sum;
}

}  // namespace

const std::vector<int>& gltf_joints(const GltfFile& file, int skin_index) {
  const tinygltf::Skin& skin = skin_at(file, skin_index);
  if (skin.joints.empty()) fail_import("skin %d has no joints; export the file again", skin_index);
  for (int joint : skin.joints)
    if (joint < 0 || static_cast<std::size_t>(joint) >= file.nodes.size())
      fail_import("joint node %d does not exist; export the file again", joint);
  return skin.joints;
}

void gltf_mark_joints(GltfFile* file) {
  for (std::size_t i = 0; i < file->visible_count; ++i) {
    const tinygltf::Node& node = file->model.nodes[static_cast<std::size_t>(file->order[i])];
    if (node.skin < 0 || node.mesh < 0) continue;
    const GltfNode& state = file->nodes[static_cast<std::size_t>(file->order[i])];
    bool moves = gltf_skin_moves(*file, node.skin) || state.weights_move || state.visibility_moves;
    if (!moves) continue;
    for (int joint : gltf_joints(*file, node.skin)) file->nodes[static_cast<std::size_t>(joint)].exported = true;
  }
}

bool gltf_skin_moves(const GltfFile& file, int skin_index) {
  for (int joint : gltf_joints(file, skin_index))
    if (file.nodes[static_cast<std::size_t>(joint)].moves) return true;
  return false;
}

std::uint32_t gltf_export_skin(GltfFile* file, int skin_index) {
  auto known = file->skins.find(skin_index);
  if (known != file->skins.end()) return known->second;
  SceneArrays& out = *file->builder->out;
  const std::vector<int>& joints = gltf_joints(*file, skin_index);
  std::vector<Transform> binds = inverse_binds(file, skin_at(*file, skin_index));
  Skin skin = {static_cast<std::uint32_t>(out.joints.size()), static_cast<std::uint32_t>(joints.size())};
  for (std::size_t j = 0; j < joints.size(); ++j)
    out.joints.push_back({file->nodes[static_cast<std::size_t>(joints[j])].out_node, binds[j]});
  out.skins.push_back(skin);
  return file->skins[skin_index] = static_cast<std::uint32_t>(out.skins.size() - 1);
}

std::vector<Transform> gltf_skin_transforms(GltfFile* file, int skin_index) {
  const std::vector<int>& joints = gltf_joints(*file, skin_index);
  std::vector<Transform> result = inverse_binds(file, skin_at(*file, skin_index));
  for (std::size_t j = 0; j < joints.size(); ++j)
    result[j] = joint_world(file->nodes[static_cast<std::size_t>(joints[j])]) * result[j];
  return result;
}

void gltf_apply_morph(MeshData* mesh, const std::vector<float>& weights) {
  std::size_t count = mesh->positions.size();
  for (std::size_t target = 0; target < mesh->morph_count; ++target) {
    if (weights[target] == 0) continue;
    mesh->tangents.clear();  // computed anew for the new shape
    for (std::size_t v = 0; v < count; ++v) {
      mesh->positions[v] += mesh->morph_positions[target * count + v] * weights[target];
      if (!mesh->morph_normals.empty()) mesh->normals[v] += mesh->morph_normals[target * count + v] * weights[target];
    }
  }
  for (Vec3& n : mesh->normals) n = normalize(n);
  mesh->morph_count = 0;
  mesh->morph_positions.clear();
  mesh->morph_normals.clear();
}

void gltf_check_joints(const MeshData& mesh, std::size_t joint_count) {
  for (const SkinWeight& weight : mesh.skin_weights)
    for (std::uint16_t joint : weight.joint)
      if (joint >= joint_count)
        fail_import("a vertex follows joint %d of %zu; export the file again", joint, joint_count);
}

void gltf_apply_skin(MeshData* mesh, const std::vector<Transform>& joints) {
  gltf_check_joints(*mesh, joints.size());
  for (std::size_t v = 0; v < mesh->positions.size(); ++v) {
    Transform t = blended(joints, mesh->skin_weights[v]);
    mesh->positions[v] = transform_point(t, mesh->positions[v]);
    if (!mesh->normals.empty()) mesh->normals[v] = transform_normal(t, mesh->normals[v]);
    if (mesh->tangents.empty()) continue;
    mesh->tangents[v].direction = transform_vector(t, mesh->tangents[v].direction);
    if (determinant(t) < 0) mesh->tangents[v].handedness *= -1;
  }
  mesh->skin_weights.clear();
}

}  // namespace pocketray
