// Reads a glTF file step by step, and places each mesh.
#include "desktop/import/gltf.h"

#include "base/limits.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

using MeshCache = std::map<int, std::vector<MeshData>>;

// True if the skin places the mesh; node transforms are then ignored (sec. 3.7.3.3).
bool is_skinned(const tinygltf::Node& node, const MeshData& mesh) {
  return node.skin >= 0 && !mesh.skin_weights.empty();
}

void append_moving(GltfFile* file, int index, const MeshData& mesh, const Transform& instance) {
  const tinygltf::Node& source = file->model.nodes[static_cast<std::size_t>(index)];
  const GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
  MovingMesh moving = {};
  if (is_skinned(source, mesh)) {
    moving.node = mesh.morph_count > 0 ? node.out_node : kNone;
    if (node.visibility_moves && mesh.morph_count == 0) gltf_fixed_part(*file, index, &moving.node);
    moving.skin = gltf_export_skin(file, source.skin);
    std::vector<Transform> joints = gltf_skin_transforms(file, source.skin);
    gltf_check_joints(mesh, joints.size());
    append_moving_mesh(file->builder, mesh, joints[0], moving);
  } else {
    moving.instance = gltf_fixed_part(*file, index, &moving.node) * instance;
    require_invertible(moving.instance, gltf_node_name(*file, index));
    append_moving_mesh(file->builder, mesh, node.world * instance, moving);
  }
}

// Poses static meshes here, once.
void append_placed(GltfFile* file, int index, MeshData mesh, const Transform& instance) {
  const tinygltf::Node& source = file->model.nodes[static_cast<std::size_t>(index)];
  const GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
  bool skinned = is_skinned(source, mesh);
  if (!skinned) mesh.skin_weights.clear();
  if (mesh.morph_count > 0 && !node.weights_move)
    gltf_apply_morph(&mesh, gltf_morph_weights(*file, index, mesh.morph_count));
  bool moves = skinned ? gltf_skin_moves(*file, source.skin) || node.visibility_moves : node.moves;
  if (moves || (mesh.morph_count > 0 && node.weights_move)) {
    mesh.tangents.clear();
    return append_moving(file, index, mesh, instance);
  }
  if (skinned) gltf_apply_skin(&mesh, gltf_skin_transforms(file, source.skin));
  if (skinned) return append_mesh(file->builder, mesh, Transform());
  const ExactTransform exactly = node.world_exactly * exact(instance);
  append_mesh(file->builder, mesh, node.world * instance, &exactly);
}

// Refuses instances beyond a limit before any is built.
void check_room(const GltfFile& file, const std::vector<MeshData>& meshes, std::uint64_t instance_count) {
  std::uint64_t vertices = 0, triangles = 0;
  for (const MeshData& mesh : meshes) vertices += mesh.positions.size(), triangles += mesh.indices.size() / 3;
  const SceneArrays& out = *file.builder->out;
  if (vertices > 0 && instance_count > (kVertexCountMax - out.positions.size()) / vertices)
    fail_import("more than %u vertices; simplify the model", kVertexCountMax);
  if (triangles > 0 && instance_count > (kTriangleCountMax - out.triangles.size()) / triangles)
    fail_import("more than %u triangles; simplify the model", kTriangleCountMax);
  require_bytes(*file.builder, instance_count, vertices * sizeof(Vec3) + triangles * sizeof(Triangle), "the geometry");
}

void append_node_meshes(GltfFile* file, int index, MeshCache* meshes) {
  const tinygltf::Node& source = file->model.nodes[static_cast<std::size_t>(index)];
  const GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
  if (source.mesh < 0 || node.unseen) return;
  auto known = meshes->find(source.mesh);
  if (known == meshes->end()) known = meshes->emplace(source.mesh, gltf_mesh(file, source.mesh)).first;
  const bool has_skin = source.skin >= 0;  // which places the mesh
  if (node.hidden && !has_skin) return;
  if (!has_skin && !node.flat) require_invertible(node.world, gltf_node_name(*file, index));
  const std::vector<Transform> instances = gltf_instances(file, index);
  check_room(*file, known->second, instances.size());
  for (const Transform& instance : instances) {
    require_invertible(instance, gltf_node_name(*file, index));
    for (const MeshData& mesh : known->second) append_placed(file, index, mesh, instance);
  }
}

// Returns the node's name, or its mesh's.
std::string part_name(const GltfFile& file, int index) {
  const tinygltf::Node& node = file.model.nodes[static_cast<std::size_t>(index)];
  const bool has_mesh = node.mesh >= 0 && static_cast<std::size_t>(node.mesh) < file.model.meshes.size();
  return node.name.empty() && has_mesh ? file.model.meshes[static_cast<std::size_t>(node.mesh)].name : node.name;
}

}  // namespace

void import_gltf(const std::string& path, Bytes bytes, SceneBuilder* builder) {
  GltfFile file;
  file.path = path;
  file.builder = builder;
  gltf_parse(&file, std::move(bytes));
  gltf_decompress(&file);
  file.materials.assign(file.model.materials.size(), kNone);
  file.uv_sets.resize(file.model.materials.size());
  gltf_visit_nodes(&file);
  gltf_count_geometry(file);
  gltf_recentre(&file);
  gltf_read_animations(&file);
  gltf_mark_movers(&file);
  gltf_mark_joints(&file);
  gltf_export_nodes(&file);
  MeshCache meshes;
  std::vector<std::uint32_t> parts(file.nodes.size(), kNone);
  for (std::size_t i = 0; i < file.visible_count; ++i) {
    const int index = file.order[i], parent = file.nodes[static_cast<std::size_t>(index)].parent;
    const std::uint32_t above = parent < 0 ? kNone : parts[static_cast<std::size_t>(parent)];
    parts[static_cast<std::size_t>(index)] = begin_part(builder, part_name(file, index), above);
    append_node_meshes(&file, index, &meshes);
  }
  gltf_lights_and_cameras(&file);
  gltf_export_animations(&file);
}

}  // namespace pocketray
