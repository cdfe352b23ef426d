// The steps of reading a glTF file, in order.
#include "import/gltf.h"

#include "import/import_error.h"

namespace pocketray {
namespace {

void append_node_meshes(GltfFile* file, int index, std::map<int, std::vector<MeshData>>* meshes) {
  const tinygltf::Node& source = file->model.nodes[static_cast<std::size_t>(index)];
  if (source.mesh < 0) return;
  const GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
  auto known = meshes->find(source.mesh);
  if (known == meshes->end()) known = meshes->emplace(source.mesh, gltf_mesh(file, source.mesh)).first;
  require_invertible(node.world, gltf_node_name(*file, index));
  for (const Transform& instance : gltf_instances(file, index)) {
    require_invertible(instance, gltf_node_name(*file, index));
    for (const MeshData& mesh : known->second) append_mesh(file->builder, mesh, node.world * instance);
  }
}

}  // namespace

void import_gltf(const std::string& path, Bytes bytes, SceneBuilder* builder) {
  GltfFile file;
  file.path = path;
  file.builder = builder;
  gltf_parse(&file, std::move(bytes));
  file.materials.assign(file.model.materials.size(), kNone);
  file.material_uv_set.assign(file.model.materials.size(), -1);
  gltf_visit_nodes(&file);
  std::map<int, std::vector<MeshData>> meshes;
  for (int index : file.order) append_node_meshes(&file, index, &meshes);
  gltf_lights_and_cameras(&file);
}

}  // namespace pocketray
