// The node tree of the default scene, and instancing (secs. 3.5, EXT_mesh_gpu_instancing).
#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

float component(const std::vector<double>& values, std::size_t index, double fallback) {
  double value = index < values.size() ? values[index] : fallback;
  return static_cast<float>(value);
}

Quaternion unit_quaternion(const Quaternion& q, bool* valid) {
  double n = std::sqrt(static_cast<double>(q.x) * q.x + static_cast<double>(q.y) * q.y +
                       static_cast<double>(q.z) * q.z + static_cast<double>(q.w) * q.w);
  *valid = n > 0 && std::isfinite(n);
  // Keeps a quaternion that is of unit length up to float rounding unchanged, bit for bit.
  if (!*valid || std::fabs(n - 1) < 1e-6) return q;
  return {static_cast<float>(q.x / n), static_cast<float>(q.y / n), static_cast<float>(q.z / n),
          static_cast<float>(q.w / n)};
}

Transform local_transform(const GltfFile& file, int index) {
  const tinygltf::Node& node = file.model.nodes[static_cast<std::size_t>(index)];
  Transform t;
  if (!node.matrix.empty()) {
    if (node.matrix.size() != 16)
      fail_import("%s: its matrix does not have 16 numbers; export the file again",
                  gltf_node_name(file, index).c_str());
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        t.m[row][column] = static_cast<float>(node.matrix[column * 4 + row]);
    return t;
  }
  Node trs = gltf_node_trs(file, index);
  return compose(trs.translation, trs.rotation, trs.scale);
}

// Local transform with the translation in double: only translations can be large relative to what they move.
ExactTransform exact_local(const GltfFile& file, int index, const Transform& local) {
  const tinygltf::Node& node = file.model.nodes[static_cast<std::size_t>(index)];
  ExactTransform t = exact(local);
  for (std::size_t c = 0; c < 3; ++c) {
    if (node.matrix.size() == 16) t.m[c][3] = node.matrix[12 + c];
    if (node.matrix.empty() && node.translation.size() == 3) t.m[c][3] = node.translation[c];
  }
  return t;
}

bool is_finite_transform(const Transform& t) {
  for (const auto& row : t.m)
    for (float value : row)
      if (!(std::fabs(value) <= kCoordinateMax)) return false;
  return true;
}

void visit(GltfFile* file, int index, int parent) {
  if (index < 0 || static_cast<std::size_t>(index) >= file->model.nodes.size())
    fail_import("node %d does not exist; export the file again", index);
  GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
  if (node.visited)
    fail_import("%s is reached twice; nodes must form a tree: export the file again",
                gltf_node_name(*file, index).c_str());
  node.visited = true;
  node.parent = parent;
  node.local = local_transform(*file, index);
  node.world = parent < 0 ? node.local : file->nodes[static_cast<std::size_t>(parent)].world * node.local;
  node.local_exactly = exact_local(*file, index, node.local);
  node.world_exactly = parent < 0 ? node.local_exactly
                                  : file->nodes[static_cast<std::size_t>(parent)].world_exactly * node.local_exactly;
  if (const tinygltf::Value* extension =
          gltf_extension(file->model.nodes[static_cast<std::size_t>(index)].extensions, "KHR_node_visibility"))
    node.visible =
        !extension->Has("visible") || !extension->Get("visible").IsBool() || extension->Get("visible").Get<bool>();
  if (!is_finite_transform(node.local) || !is_finite_transform(node.world))
    fail_import("%s: its transform is not finite; export the file again", gltf_node_name(*file, index).c_str());
  file->order.push_back(index);
}

void visit_tree(GltfFile* file, int root) {
  std::vector<std::pair<int, int>> stack = {{root, -1}};  // node, parent
  while (!stack.empty()) {
    auto [index, parent] = stack.back();
    stack.pop_back();
    visit(file, index, parent);
    const std::vector<int>& children = file->model.nodes[static_cast<std::size_t>(index)].children;
    for (auto child = children.rbegin(); child != children.rend(); ++child) stack.emplace_back(*child, index);
  }
}

std::vector<int> parents_of(const tinygltf::Model& model) {
  std::vector<int> parents(model.nodes.size(), -1);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    for (int child : model.nodes[i].children)
      if (child >= 0 && static_cast<std::size_t>(child) < parents.size())
        parents[static_cast<std::size_t>(child)] = static_cast<int>(i);
  return parents;
}

}  // namespace

Node gltf_node_trs(const GltfFile& file, int index) {
  const tinygltf::Node& source = file.model.nodes[static_cast<std::size_t>(index)];
  Node node;
  for (int c = 0; c < 3; ++c) {
    node.translation[c] = component(source.translation, static_cast<std::size_t>(c), 0);
    node.scale[c] = component(source.scale, static_cast<std::size_t>(c), 1);
  }
  Quaternion q = {component(source.rotation, 0, 0), component(source.rotation, 1, 0), component(source.rotation, 2, 0),
                  component(source.rotation, 3, 1)};
  bool valid;
  node.rotation = unit_quaternion(q, &valid);
  if (!valid)
    fail_import("%s: its rotation is not a quaternion; export the file again", gltf_node_name(file, index).c_str());
  return node;
}

std::string gltf_node_name(const GltfFile& file, int index) {
  const std::string& name = file.model.nodes[static_cast<std::size_t>(index)].name;
  return "node " + std::to_string(index) + (name.empty() ? "" : " '" + name.substr(0, 60) + "'");
}

void gltf_visit_nodes(GltfFile* file) {
  const tinygltf::Model& model = file->model;
  if (model.nodes.size() > kNodeCountMax) fail_import("more than %u nodes; merge some", kNodeCountMax);
  file->nodes.assign(model.nodes.size(), GltfNode());
  std::vector<int> parents = parents_of(model);
  if (model.scenes.empty()) {
    // Without a scene, every node without a parent is a root.
    for (std::size_t i = 0; i < parents.size(); ++i)
      if (parents[i] < 0) visit_tree(file, static_cast<int>(i));
  } else {
    int chosen = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (static_cast<std::size_t>(chosen) >= model.scenes.size())
      fail_import("scene %d does not exist; export the file again", chosen);
    if (model.scenes.size() > 1)
      note_unused(file->builder, std::to_string(model.scenes.size() - 1) +
                                     (model.scenes.size() == 2 ? " other scene" : " other scenes"));
    for (int root : model.scenes[static_cast<std::size_t>(chosen)].nodes) visit_tree(file, root);
  }
  file->visible_count = file->order.size();
  for (std::size_t i = 0; i < file->visible_count; ++i) {
    int skin = model.nodes[static_cast<std::size_t>(file->order[i])].skin;
    if (skin < 0) continue;
    for (int joint : gltf_joints(*file, skin)) {
      if (file->nodes[static_cast<std::size_t>(joint)].visited) continue;
      int root = joint;
      std::size_t steps = 0;
      while (parents[static_cast<std::size_t>(root)] >= 0 && steps++ < parents.size())
        root = parents[static_cast<std::size_t>(root)];
      visit_tree(file, root);
    }
  }
}

// Adds the bounds of a mesh's primitives, as stated in the file, by their corners.
static void measure_mesh(const GltfFile& file, int index, const ExactTransform& world, ExactExtent* extent) {
  if (index < 0 || static_cast<std::size_t>(index) >= file.model.meshes.size()) return;
  const auto& accessors = file.model.accessors;
  for (const tinygltf::Primitive& primitive : file.model.meshes[static_cast<std::size_t>(index)].primitives) {
    const auto found = primitive.attributes.find("POSITION");
    if (found == primitive.attributes.end() || static_cast<std::size_t>(found->second) >= accessors.size()) continue;
    const tinygltf::Accessor& positions = accessors[static_cast<std::size_t>(found->second)];
    if (positions.minValues.size() < 3 || positions.maxValues.size() < 3) continue;
    auto corner = [&](std::size_t i) {
      auto side = [&](std::size_t c) { return (i >> c & 1 ? positions.maxValues : positions.minValues)[c]; };
      return Vec3d{side(0), side(1), side(2)};
    };
    const bool has_indices = static_cast<std::size_t>(primitive.indices) < accessors.size();
    const std::size_t corners =
        (has_indices ? accessors[static_cast<std::size_t>(primitive.indices)] : positions).count;
    add_points(extent, 8, corner, world, static_cast<double>(corners / 3));
  }
}

void gltf_recentre(GltfFile* file) {
  ExactExtent extent;
  for (std::size_t i = 0; i < file->visible_count; ++i) {
    const GltfNode& node = file->nodes[static_cast<std::size_t>(file->order[i])];
    measure_mesh(*file, file->model.nodes[static_cast<std::size_t>(file->order[i])].mesh, node.world_exactly, &extent);
  }
  const Vec3d origin = choose_origin(extent, file->builder);
  if (file->builder->out->origin.empty()) return;
  for (int index : file->order) {
    GltfNode& node = file->nodes[static_cast<std::size_t>(index)];
    node.world = recentred(node.world_exactly, origin);
  }
}

Transform gltf_fixed_part(const GltfFile& file, int index, std::uint32_t* out_node) {
  const GltfNode& node = file.nodes[static_cast<std::size_t>(index)];
  *out_node = kNone;
  if (node.mover < 0) return node.world;
  *out_node = file.nodes[static_cast<std::size_t>(node.mover)].out_node;
  Transform t;
  for (int at = index; at != node.mover; at = file.nodes[static_cast<std::size_t>(at)].parent)
    t = file.nodes[static_cast<std::size_t>(at)].local * t;
  return t;
}

std::vector<Transform> gltf_instances(GltfFile* file, int index) {
  const tinygltf::Value* extension =
      gltf_extension(file->model.nodes[static_cast<std::size_t>(index)].extensions, "EXT_mesh_gpu_instancing");
  if (!extension || !extension->Has("attributes") || !extension->Get("attributes").IsObject()) return {Transform()};
  const tinygltf::Value& attributes = extension->Get("attributes");
  std::vector<float> values[3];
  const char* const names[3] = {"TRANSLATION", "ROTATION", "SCALE"};
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    double accessor = gltf_number(attributes, names[k], -1);
    if (accessor < 0) continue;
    int components = k == 1 ? 4 : 3;
    values[k] =
        gltf_floats(file, accessor < 1e9 ? static_cast<int>(accessor) : -1, components, "EXT_mesh_gpu_instancing");
    std::size_t own = values[k].size() / static_cast<std::size_t>(components);
    if (count != 0 && own != count)
      fail_import("%s: its instance attributes differ in length; export the file again",
                  gltf_node_name(*file, index).c_str());
    count = own;
  }
  require_bytes(*file->builder, count, sizeof(Transform), "the instances");
  std::vector<Transform> instances(count);
  for (std::size_t i = 0; i < count; ++i) {
    auto at = [&](int k, std::size_t c, float fallback) {
      return values[k].empty() ? fallback : values[k][i * (k == 1 ? 4 : 3) + c];
    };
    bool valid;
    Quaternion q = unit_quaternion({at(1, 0, 0), at(1, 1, 0), at(1, 2, 0), at(1, 3, 1)}, &valid);
    instances[i] = compose({at(0, 0, 0), at(0, 1, 0), at(0, 2, 0)}, q, {at(2, 0, 1), at(2, 1, 1), at(2, 2, 1)});
    if (!valid || !is_finite_transform(instances[i]))
      fail_import("%s: instance %zu is not finite; export the file again", gltf_node_name(*file, index).c_str(), i);
  }
  return instances;
}

}  // namespace pocketray
