// Mesh primitives (secs. 3.7.2, 3.7.3).
#include <algorithm>
#include <limits>

#include "base/limits.h"
#include "desktop/import/broken_faces.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"
#include "desktop/import/tangents.h"

namespace pocketray {
namespace {

int attribute(const tinygltf::Primitive& primitive, const char* name) {
  auto it = primitive.attributes.find(name);
  return it == primitive.attributes.end() ? -1 : it->second;
}

std::uint16_t to_u16(float value) {
  if (!(value > 0)) return 0;
  return value >= 1 ? 65535 : static_cast<std::uint16_t>(value * 65535.0f + 0.5f);
}

// Returns the corner indices of the triangles that `mode` makes of `count` corners (sec. 3.7.2.1).
std::vector<std::uint32_t> triangle_corners(int mode, std::size_t count) {
  std::vector<std::uint32_t> corners;
  std::uint32_t n = static_cast<std::uint32_t>(count);
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    corners.resize(n / 3 * 3);
    for (std::uint32_t i = 0; i < corners.size(); ++i) corners[i] = i;
  } else {
    for (std::uint32_t i = 0; i + 2 < n; ++i) {
      if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
        corners.insert(corners.end(), {i, i + 1 + i % 2, i + 2 - i % 2});
      else
        corners.insert(corners.end(), {i + 1, i + 2, 0});
    }
  }
  return corners;
}

void require_count(std::size_t got, std::size_t wanted, const char* what) {
  if (got != wanted) fail_import("%s: %zu elements for %zu vertices; export the file again", what, got, wanted);
}

void read_indices(GltfFile* file, const tinygltf::Primitive& primitive, MeshData* mesh) {
  std::vector<std::uint32_t> indices;
  std::size_t count = mesh->positions.size();
  if (primitive.indices >= 0) {
    indices = gltf_uints(file, primitive.indices, 1, "mesh indices");
    count = indices.size();
  }
  require_bytes(*file->builder, count, 3 * sizeof(std::uint32_t), "mesh indices");
  mesh->indices = triangle_corners(primitive.mode, count);
  if (primitive.indices >= 0)
    for (std::uint32_t& corner : mesh->indices) corner = indices[corner];
}

void read_colors(GltfFile* file, int accessor, MeshData* mesh) {
  int components = gltf_component_count(*file, accessor) == 4 ? 4 : 3;
  std::vector<float> values = gltf_attribute(file, accessor, components, "COLOR_0");
  std::size_t n = static_cast<std::size_t>(components);
  require_count(values.size() / n, mesh->positions.size(), "COLOR_0");
  bool colored = false;
  for (std::size_t i = 0; i < values.size(); i += n) {
    const float* c = &values[i];
    mesh->colors.push_back(
        {to_u16(c[0]), to_u16(c[1]), to_u16(c[2]), components == 4 ? to_u16(c[3]) : std::uint16_t(65535)});
    const Rgba16& last = mesh->colors.back();
    colored |= last.r != 65535 || last.g != 65535 || last.b != 65535 || last.a != 65535;
  }
  if (!colored) mesh->colors.clear();
}

void read_uvs(GltfFile* file, const tinygltf::Primitive& primitive, int set, const MeshData& mesh,
              std::vector<Vec2>* uvs) {
  if (set < 0) return;
  int accessor = attribute(primitive, ("TEXCOORD_" + std::to_string(set)).c_str());
  if (accessor < 0) {
    note_remark(file->builder, "a mesh lacks TEXCOORD_" + std::to_string(set) + ", which its material uses");
    return;
  }
  std::vector<float> values = gltf_attribute(file, accessor, 2, "TEXCOORD");
  require_count(values.size() / 2, mesh.positions.size(), "TEXCOORD");
  uvs->resize(mesh.positions.size());
  for (std::size_t i = 0; i < uvs->size(); ++i) {
    const Vec2 place = {values[2 * i], values[2 * i + 1]};
    (*uvs)[i] = is_coordinate({place.x, place.y, 0}) ? place : Vec2{0, 0};
  }
}

// Reads the file's tangents if the material needs them (sec. 3.7.2.1); zero where a tangent is along the normal or has
// no handedness, so that it is computed as for files without.
void read_tangents(GltfFile* file, const tinygltf::Primitive& primitive, MeshData* mesh) {
  constexpr double kSineMin = 1e-3;  // chosen: above directions that stem from rounding
  const int accessor = attribute(primitive, "TANGENT");
  if (accessor < 0 || mesh->normals.empty() || !needs_tangents(*file->builder->out, mesh->material)) return;
  std::vector<float> values;
  try {
    values = gltf_floats(file, accessor, 4, "TANGENT");
    require_count(values.size() / 4, mesh->positions.size(), "TANGENT");
  } catch (const ImportError& error) {
    note_remark(file->builder, std::string("tangents are recomputed: ") + error.what());
    return;
  }
  std::size_t unusable = 0;
  for (std::size_t i = 0; i < mesh->normals.size(); ++i) {
    const float* t = &values[4 * i];
    const Vec3d way = normalize(Vec3d{t[0], t[1], t[2]}), n = to_double(mesh->normals[i]), flat = way - n * dot(n, way);
    const bool is_usable = length(flat) > kSineMin && t[3] != 0;
    unusable += !is_usable;
    mesh->tangents.push_back({is_usable ? to_float(normalize(flat)) : Vec3{0, 0, 0}, t[3] < 0 ? -1 : 1});
  }
  if (unusable)
    note_remark(file->builder, "tangents that are zero, along the normal or without handedness are recomputed");
}

void read_skin_weights(GltfFile* file, const tinygltf::Primitive& primitive, MeshData* mesh) {
  int joints = attribute(primitive, "JOINTS_0"), weights = attribute(primitive, "WEIGHTS_0");
  if (joints < 0 || weights < 0) return;
  if (attribute(primitive, "JOINTS_1") >= 0) note_unused(file->builder, "more than four joints per vertex");
  std::vector<std::uint32_t> joint = gltf_uints(file, joints, 4, "JOINTS_0");
  std::vector<float> weight = gltf_attribute(file, weights, 4, "WEIGHTS_0");
  require_count(joint.size() / 4, mesh->positions.size(), "JOINTS_0");
  require_count(weight.size() / 4, mesh->positions.size(), "WEIGHTS_0");
  mesh->skin_weights.resize(mesh->positions.size());
  for (std::size_t i = 0; i < mesh->skin_weights.size(); ++i) {
    SkinWeight& s = mesh->skin_weights[i];
    float sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      float w = weight[4 * i + k];
      s.weight[k] = w > 0 ? w : 0;
      if (s.weight[k] > 0 && joint[4 * i + k] > 65535)
        fail_import("JOINTS_0: joint %u; export the file again", joint[4 * i + k]);
      s.joint[k] = s.weight[k] > 0 ? static_cast<std::uint16_t>(joint[4 * i + k]) : std::uint16_t(0);
      sum += s.weight[k];
    }
    // Weights are normalised to sum to one; a vertex without weights follows its first joint.
    if (!(sum > 0)) s.weight[0] = sum = 1;
    for (float& w : s.weight) w = w / sum;
  }
}

void read_morph_targets(GltfFile* file, const tinygltf::Primitive& primitive, MeshData* mesh) {
  if (primitive.targets.size() > kMorphTargetCountMax)
    fail_import("more than %u morph targets; export fewer", kMorphTargetCountMax);
  std::size_t count = mesh->positions.size();
  require_bytes(*file->builder, primitive.targets.size(), count * 2 * sizeof(Vec3), "the morph targets");
  mesh->morph_count = static_cast<std::uint32_t>(primitive.targets.size());
  bool normals = false;
  for (const auto& target : primitive.targets) normals |= target.count("NORMAL") > 0;
  for (const auto& target : primitive.targets) {
    for (auto* list : {&mesh->morph_positions, &mesh->morph_normals}) {
      bool is_normal = list == &mesh->morph_normals;
      if (is_normal && (!normals || mesh->normals.empty())) continue;
      auto found = target.find(is_normal ? "NORMAL" : "POSITION");
      std::vector<Vec3> deltas(count, Vec3{0, 0, 0});
      if (found != target.end()) deltas = gltf_vec3s(file, found->second, "a morph target");
      require_count(deltas.size(), count, "a morph target");
      if (is_normal)
        std::replace_if(
            deltas.begin(), deltas.end(), [](const Vec3& d) { return !is_finite(d); }, Vec3{0, 0, 0});
      list->insert(list->end(), deltas.begin(), deltas.end());
    }
  }
}

MeshData read_primitive(GltfFile* file, const tinygltf::Primitive& primitive, const std::string& name) {
  MeshData mesh;
  mesh.name = name;
  mesh.positions = gltf_vec3s(file, attribute(primitive, "POSITION"), "POSITION");
  read_indices(file, primitive, &mesh);
  if (mesh.indices.empty()) return mesh;
  int normals = attribute(primitive, "NORMAL"), colors = attribute(primitive, "COLOR_0");
  if (normals >= 0) {
    mesh.normals = gltf_vec3s(file, normals, "NORMAL", std::numeric_limits<float>::max());
    require_count(mesh.normals.size(), mesh.positions.size(), "NORMAL");
    for (Vec3& n : mesh.normals) n = normalize(n);
  }
  mesh.material = gltf_material(file, primitive.material);
  if (primitive.material >= 0) {
    const GltfUvSets& sets = file->uv_sets[static_cast<std::size_t>(primitive.material)];
    read_uvs(file, primitive, sets.first, mesh, &mesh.uvs);
    read_uvs(file, primitive, sets.second, mesh, &mesh.second_uvs);
  }
  read_tangents(file, primitive, &mesh);
  if (colors >= 0) read_colors(file, colors, &mesh);
  if (attribute(primitive, "COLOR_1") >= 0) note_unused(file->builder, "second vertex colours");
  read_skin_weights(file, primitive, &mesh);
  read_morph_targets(file, primitive, &mesh);
  leave_out_broken_faces(&mesh, file->builder);
  tidy_mesh(&mesh);
  return mesh;
}

std::string mesh_name(const tinygltf::Mesh& mesh, int index) {
  return "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " '" + mesh.name.substr(0, 60) + "'");
}

}  // namespace

std::vector<MeshData> gltf_mesh(GltfFile* file, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= file->model.meshes.size())
    fail_import("mesh %d does not exist; export the file again", index);
  const tinygltf::Mesh& mesh = file->model.meshes[static_cast<std::size_t>(index)];
  std::vector<MeshData> result;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    int mode = primitive.mode;
    if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN)
      fail_import("mesh %d has a primitive of mode %d; export the file again", index, mode);
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      note_unused(file->builder, mode == TINYGLTF_MODE_POINTS ? "points" : "lines");
      continue;
    }
    if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) >= file->model.materials.size())
      fail_import("material %d does not exist; export the file again", primitive.material);
    if (attribute(primitive, "POSITION") < 0) {
      note_unused(file->builder, "meshes without positions");
      continue;
    }
    MeshData data = read_primitive(file, primitive, mesh_name(mesh, index));
    if (data.indices.empty())
      note_unused(file->builder, "meshes without triangles");
    else
      result.push_back(std::move(data));
  }
  return result;
}

}  // namespace pocketray
