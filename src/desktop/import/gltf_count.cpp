// Counts the geometry of the scene before any is built: a few bytes of instances can multiply a mesh.
#include <algorithm>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

struct Count {
  double vertices = 0, triangles = 0;  // may exceed integers
};

// Returns 0 if there is no such accessor or its count exceeds its bytes; reading it then reports the error.
double accessor_count(const GltfFile& file, int index) {
  const tinygltf::Model& model = file.model;
  if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size()) return 0;
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const bool has_bytes =
      accessor.bufferView >= 0 && static_cast<std::size_t>(accessor.bufferView) < model.bufferViews.size();
  const std::uint64_t bytes =
      has_bytes ? model.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteLength : gltf_bytes(file);
  return accessor.count > bytes ? 0 : static_cast<double>(accessor.count);
}

Count count_mesh(const GltfFile& file, const tinygltf::Mesh& mesh) {
  Count count;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    const bool strip = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP || primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
    if (!strip && primitive.mode >= 0 && primitive.mode != TINYGLTF_MODE_TRIANGLES) continue;
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) continue;
    const double vertices = accessor_count(file, position->second);
    const double corners = primitive.indices >= 0 ? accessor_count(file, primitive.indices) : vertices;
    count.vertices += vertices;
    count.triangles += strip ? std::max(corners - 2, 0.0) : corners / 3;
  }
  return count;
}

double count_instances(const GltfFile& file, const tinygltf::Node& node) {
  const tinygltf::Value* extension = gltf_extension(node.extensions, "EXT_mesh_gpu_instancing");
  if (!extension || !extension->Has("attributes") || !extension->Get("attributes").IsObject()) return 1;
  double count = 0;
  for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
    const double accessor = gltf_number(extension->Get("attributes"), name, -1);
    if (accessor >= 0 && accessor < 1e9) count = std::max(count, accessor_count(file, static_cast<int>(accessor)));
  }
  return count;
}

}  // namespace

void gltf_count_geometry(const GltfFile& file) {
  Count total;
  for (std::size_t i = 0; i < file.visible_count; ++i) {
    const tinygltf::Node& node = file.model.nodes[static_cast<std::size_t>(file.order[i])];
    if (node.mesh < 0 || static_cast<std::size_t>(node.mesh) >= file.model.meshes.size()) continue;
    const Count mesh = count_mesh(file, file.model.meshes[static_cast<std::size_t>(node.mesh)]);
    const double instances = count_instances(file, node);
    total.vertices += instances * mesh.vertices, total.triangles += instances * mesh.triangles;
  }
  if (total.vertices > kVertexCountMax) fail_import("more than %u vertices; simplify the model", kVertexCountMax);
  if (total.triangles > kTriangleCountMax) fail_import("more than %u triangles; simplify the model", kTriangleCountMax);
  const double bytes = total.vertices * sizeof(Vec3) + total.triangles * sizeof(Triangle);
  require_bytes(*file.builder, static_cast<std::uint64_t>(bytes), 1, "the geometry");
}

}  // namespace pocketray
