#include "import/obj.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <istream>
#include <sstream>
#include <streambuf>
#include <string_view>

#include "base/color.h"
#include "import/import_error.h"
#include "import/normals.h"
#include "import/obj_exact.h"
#include "import/obj_material.h"
#include "import/obj_numbers.h"
#include "import/obj_text.h"

namespace pocketray {
namespace {

struct MemoryBuffer : std::streambuf {
  explicit MemoryBuffer(const Bytes& bytes) {
    char* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    setg(begin, begin, begin + bytes.size());
  }
};

// What follows "mtllib", where spaces divide it.
std::vector<std::string> names_with_spaces(const Bytes& text) {
  constexpr char kWord[] = "mtllib ";
  constexpr char kBlank[] = " \t\r";
  std::vector<std::string> names;
  const std::string_view all(reinterpret_cast<const char*>(text.data()), text.size());
  for (std::size_t at = all.find(kWord); at != all.npos && names.size() < 64; at = all.find(kWord, at + 1)) {
    if (at > 0 && all[at - 1] != '\n') continue;
    std::string_view name = all.substr(at + sizeof kWord - 1);
    name = name.substr(0, name.find('\n'));
    name.remove_prefix(std::min(name.find_first_not_of(kBlank), name.size()));
    name = name.substr(0, name.find_last_not_of(kBlank) + 1);
    if (name.find(' ') != name.npos && name.size() < 4096) names.emplace_back(name);
  }
  return names;
}

// Reads .mtl files beside the scene file; a missing one is a remark.
class MaterialFiles : public tinyobj::MaterialReader {
 public:
  MaterialFiles(const std::string& scene_path, const Bytes& text, SceneBuilder* builder)
      : scene_path_(scene_path), builder_(builder), spaced_names_(names_with_spaces(text)) {}
  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* by_name, std::string* warning, std::string* error) override {
    Bytes bytes;
    if (!read_spaced(name, &bytes)) {
      try {
        bytes = read_beside(scene_path_, name, builder_->options.byte_count_max / 16, &builder_->files);
        tidy_obj_text(&bytes);
      } catch (const ImportError& failure) {
        note_remark(builder_, std::string("materials are missing: ") + failure.what());
        return false;
      }
    }
    check_mtl_numbers(bytes, name);
    MemoryBuffer buffer(bytes);
    std::istream stream(&buffer);
    tinyobj::LoadMtl(by_name, materials, &stream, warning, error);
    return true;
  }

 private:
  // The library divides a name at its spaces, and asks for the parts: the file named by the whole line comes first.
  bool read_spaced(const std::string& part, Bytes* bytes) {
    for (const std::string& whole : spaced_names_)
      if (whole.compare(0, part.size() + 1, part + ' ') == 0) try {
          *bytes = read_beside(scene_path_, whole, builder_->options.byte_count_max / 16, &builder_->files);
          tidy_obj_text(bytes);
          return true;
        } catch (const ImportError&) {
        }
    return false;
  }

  std::string scene_path_;
  SceneBuilder* builder_;
  std::vector<std::string> spaced_names_;
};

std::uint16_t linear_16(float srgb) {
  double c = srgb > 0 ? (srgb < 1 ? static_cast<double>(srgb) : 1.0) : 0.0;
  return static_cast<std::uint16_t>(srgb_decode(c) * 65535.0 + 0.5);
}

// Finds or makes the vertex of a corner: OBJ indexes positions, normals and texture coordinates separately.
class CornerIndex {
 public:
  explicit CornerIndex(const tinyobj::attrib_t& attributes)
      : attributes_(attributes), head_(attributes.vertices.size() / 3, kNone) {}

  void begin_mesh() {
    for (const tinyobj::index_t& corner : corners_) head_[static_cast<std::size_t>(corner.vertex_index)] = kNone;
    corners_.clear();
    next_.clear();
  }

  std::uint32_t vertex(const tinyobj::index_t& corner, bool normals, bool uvs, MeshData* mesh) {
    std::size_t p = static_cast<std::size_t>(corner.vertex_index);
    for (std::uint32_t at = head_[p]; at != kNone; at = next_[at])
      if (corners_[at].normal_index == corner.normal_index && corners_[at].texcoord_index == corner.texcoord_index)
        return at;
    std::uint32_t made = static_cast<std::uint32_t>(corners_.size());
    corners_.push_back(corner);
    next_.push_back(head_[p]);
    head_[p] = made;
    const float* v = &attributes_.vertices[3 * p];
    mesh->positions.push_back({v[0], v[1], v[2]});
    if (normals) {
      const float* n =
          corner.normal_index >= 0 ? &attributes_.normals[3 * static_cast<std::size_t>(corner.normal_index)] : nullptr;
      mesh->normals.push_back(n ? normalize(Vec3{n[0], n[1], n[2]}) : Vec3{0, 0, 0});
    }
    if (uvs) {
      const float* t = corner.texcoord_index >= 0
                           ? &attributes_.texcoords[2 * static_cast<std::size_t>(corner.texcoord_index)]
                           : nullptr;
      mesh->uvs.push_back(t ? Vec2{t[0], 1 - t[1]} : Vec2{0, 0});  // v runs upward in OBJ
    }
    if (!attributes_.colors.empty()) {
      const float* c = &attributes_.colors[3 * p];
      mesh->colors.push_back({linear_16(c[0]), linear_16(c[1]), linear_16(c[2]), 65535});
    }
    return made;
  }

 private:
  const tinyobj::attrib_t& attributes_;
  std::vector<std::uint32_t> head_, next_;  // chains of vertices that share a position
  std::vector<tinyobj::index_t> corners_;
};

// A face may refer to missing normals or texture coordinates, but not to a missing position.
tinyobj::index_t checked_corner(tinyobj::index_t corner, const tinyobj::attrib_t& attributes, SceneBuilder* builder) {
  auto beyond = [](int index, std::size_t count) { return index >= 0 && static_cast<std::size_t>(index) >= count; };
  if (corner.vertex_index < 0 || beyond(corner.vertex_index, attributes.vertices.size() / 3))
    fail_import("a face uses vertex %d of %zu; export the file again", corner.vertex_index + 1,
                attributes.vertices.size() / 3);
  bool no_normal = beyond(corner.normal_index, attributes.normals.size() / 3);
  bool no_uv = beyond(corner.texcoord_index, attributes.texcoords.size() / 2);
  if (no_normal || no_uv) note_remark(builder, "faces refer to missing normals or texture coordinates");
  if (no_normal || corner.normal_index < 0) corner.normal_index = -1;
  if (no_uv || corner.texcoord_index < 0) corner.texcoord_index = -1;
  return corner;
}

bool uses_uvs(const SceneBuilder& builder, std::uint32_t index) {
  const SceneArrays& out = *builder.out;
  const Material& material = out.materials[index];
  if (material.diffuse_texture.texture != kNone || material.emission_texture.texture != kNone) return true;
  return index < out.grains.size() && has_strength(out.grains[index]);
}

MeshData shape_mesh(const tinyobj::shape_t& shape, const tinyobj::attrib_t& attributes, std::uint32_t default_material,
                    CornerIndex* index, SceneBuilder* builder) {
  MeshData mesh;
  index->begin_mesh();
  bool normals = false, uvs = false, missing = false;
  std::size_t triangle_count = shape.mesh.indices.size() / 3;
  for (std::size_t t = 0; t < triangle_count; ++t) {
    if (t < shape.mesh.num_face_vertices.size() && shape.mesh.num_face_vertices[t] != 3)
      fail_import("a face of '%.60s' cannot be triangulated; triangulate the model", shape.name.c_str());
    int id = t < shape.mesh.material_ids.size() ? shape.mesh.material_ids[t] : -1;
    bool known = id >= 0 && static_cast<std::uint32_t>(id) < default_material;
    mesh.triangle_materials.push_back(known ? static_cast<std::uint32_t>(id) : default_material);
    uvs |= uses_uvs(*builder, mesh.triangle_materials.back());
  }
  std::vector<tinyobj::index_t> corners(3 * triangle_count);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    corners[c] = checked_corner(shape.mesh.indices[c], attributes, builder);
    normals |= corners[c].normal_index >= 0;
    missing |= uvs && corners[c].texcoord_index < 0;
    if (!uvs) corners[c].texcoord_index = -1;
  }
  if (missing) note_remark(builder, "a mesh lacks texture coordinates, which its material uses");
  for (const tinyobj::index_t& corner : corners) mesh.indices.push_back(index->vertex(corner, normals, uvs, &mesh));
  return mesh;
}

}  // namespace

void import_obj(const std::string& path, Bytes bytes, SceneBuilder* builder) {
  require_bytes(*builder, bytes.size(), 8, "the OBJ text");
  tidy_obj_text(&bytes);
  check_obj_numbers(bytes);
  recentre_obj(builder, &bytes);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  MemoryBuffer buffer(bytes);
  std::istream stream(&buffer);
  MaterialFiles material_files(path, bytes, builder);
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream, &material_files, true, false))
    fail_import("%.300s (as tinyobjloader reports); export the file again",
                error.empty() ? warning.c_str() : error.c_str());
  if (warning.find("not found in .mtl") != std::string::npos)
    note_remark(builder, "faces without a known material got the default one");
  for (const tinyobj::material_t& material : materials) add_obj_material(builder, path, material);
  std::uint32_t default_material = static_cast<std::uint32_t>(builder->out->materials.size());
  builder->out->materials.emplace_back();

  CornerIndex index(attributes);
  bool default_used = false;
  for (const tinyobj::shape_t& shape : shapes) {
    if (!shape.lines.indices.empty()) note_unused(builder, "lines");
    if (!shape.points.indices.empty()) note_unused(builder, "points");
    require_bytes(*builder, shape.mesh.indices.size(), 32, "the geometry");
    MeshData mesh = shape_mesh(shape, attributes, default_material, &index, builder);
    for (std::uint32_t material : mesh.triangle_materials) default_used |= material == default_material;
    if (mesh.normals.empty()) smooth_normals(&mesh, builder->options.crease_angle);
    mesh.name = "'" + shape.name.substr(0, 60) + "'";
    tidy_mesh(&mesh);
    begin_part(builder, shape.name);
    append_mesh(builder, mesh, Transform());
  }
  if (!default_used && default_material > 0) builder->out->materials.pop_back();
}

}  // namespace pocketray
