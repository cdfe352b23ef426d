#include "desktop/import/obj.h"

#include <algorithm>
#include <sstream>
#include <unordered_map>

#include "base/color.h"
#include "desktop/import/import_error.h"
#include "desktop/import/normals.h"
#include "desktop/import/obj_file.h"
#include "desktop/import/obj_lookup.h"
#include "desktop/import/obj_material.h"
#include "desktop/import/obj_surfaces.h"
#include "desktop/import/obj_text.h"
#include "desktop/import/origin.h"
#include "desktop/import/polygon.h"
#include "desktop/import/upright.h"

namespace pocketray {
namespace {

// Reads the MTL files that the model names or, if none exists, the one named like the model.
class MaterialFiles {
 public:
  MaterialFiles(const std::string& scene_path, SceneBuilder* builder) : scene_path_(scene_path), builder_(builder) {}

  std::vector<MtlMaterial> read(const ObjFile& file) {
    for (const std::string& line : file.material_files) read_line(line);
    if (materials_.empty() && !file.material_names.empty()) read_own();
    for (const std::string& error : errors_) note_remark(builder_, "materials are missing: " + error);
    return std::move(materials_);
  }

 private:
  // Names may contain spaces, so the whole line is tried first, then each word.
  void read_line(const std::string& line) {
    std::string whole = line;
    for (std::size_t at; (at = whole.find("\\ ")) != whole.npos;) whole.erase(at, 1);
    std::string error;
    if (whole.empty() || read(whole, &error)) return;
    std::istringstream words(whole);
    std::vector<std::string> errors;
    bool is_any = false;
    for (std::string word; words >> word;) {
      std::string why;
      if (word == whole) break;
      if (read(word, &why))
        is_any = true;
      else
        errors.push_back(why);
    }
    if (!is_any) errors_.push_back(error);
  }

  // Reads the file named like the model, if it exists.
  void read_own() {
    const std::string name = path_stem(scene_path_) + ".mtl";
    std::string error;
    if (!read(name, &error)) return;
    note_remark(builder_, "its materials are those of " + name + ", which it does not name");
    errors_.clear();
  }

  bool read(const std::string& name, std::string* error) {
    Bytes bytes;
    std::string path;
    try {
      bytes = read_named({scene_path_}, name, builder_->options.byte_count_max / 16, builder_, &path);
      tidy_obj_text(&bytes);
    } catch (const ImportError& failure) {
      *error = failure.what();
      return false;
    }
    const std::size_t begin = materials_.size();
    read_mtl_file(bytes, name, builder_, &materials_);
    for (std::size_t i = begin; i < materials_.size(); ++i) materials_[i].path = path;
    return true;
  }

  std::string scene_path_;
  SceneBuilder* builder_;
  std::vector<MtlMaterial> materials_;
  std::vector<std::string> errors_;
};

std::uint16_t linear_16(float srgb) {
  double c = srgb > 0 ? (srgb < 1 ? static_cast<double>(srgb) : 1.0) : 0.0;
  return static_cast<std::uint16_t>(srgb_decode(c) * 65535.0 + 0.5);
}

// Finds or makes the vertex of a corner: OBJ indexes positions, normals and texture coordinates separately.
class CornerIndex {
 public:
  // Positions are stored relative to `origin`.
  CornerIndex(const ObjFile& file, const Vec3d& origin)
      : file_(file), origin_(origin), head_(file.positions.size() / 3, kNone) {}

  void begin_mesh() {
    for (const ObjCorner& corner : corners_)
      if (corner.position != kNoElement) head_[static_cast<std::size_t>(corner.position)] = kNone;
    corners_.clear();
    next_.clear();
  }

  std::uint32_t vertex(const ObjCorner& corner, bool normals, bool uvs, MeshData* mesh) {
    const std::size_t p = static_cast<std::size_t>(corner.position);
    for (std::uint32_t at = head_[p]; at != kNone; at = next_[at])
      if (corners_[at].normal == corner.normal && corners_[at].uv == corner.uv) return at;
    // Vertices where polygons cross themselves belong to no corner.
    corners_.resize(mesh->positions.size(), {kNoElement, kNoElement, kNoElement});
    next_.resize(mesh->positions.size(), kNone);
    const std::uint32_t made = static_cast<std::uint32_t>(corners_.size());
    corners_.push_back(corner);
    next_.push_back(head_[p]);
    head_[p] = made;
    const double* v = &file_.positions[3 * p];
    mesh->positions.push_back(to_float(Vec3d{v[0], v[1], v[2]} - origin_));
    if (normals) {
      const float* n = corner.normal >= 0 ? &file_.normals[3 * static_cast<std::size_t>(corner.normal)] : nullptr;
      mesh->normals.push_back(n ? normalize(Vec3{n[0], n[1], n[2]}) : Vec3{0, 0, 0});
    }
    if (uvs) {
      const float* t = corner.uv >= 0 ? &file_.uvs[2 * static_cast<std::size_t>(corner.uv)] : nullptr;
      mesh->uvs.push_back(t ? Vec2{t[0], 1 - t[1]} : Vec2{0, 0});  // v runs upward in OBJ
    }
    if (!file_.colors.empty()) {
      const float* c = &file_.colors[3 * p];
      mesh->colors.push_back({linear_16(c[0]), linear_16(c[1]), linear_16(c[2]), 65535});
    }
    return made;
  }

  // Index into the file's positions of a vertex of the mesh; kNoElement where polygons cross themselves.
  std::int32_t position(std::uint32_t vertex) const {
    return vertex < corners_.size() ? corners_[vertex].position : kNoElement;
  }

 private:
  const ObjFile& file_;
  Vec3d origin_;
  std::vector<std::uint32_t> head_, next_;  // chains of vertices that share a position
  std::vector<ObjCorner> corners_;
};

// A face may refer to missing normals or texture coordinates, but not to a missing position.
ObjCorner checked_corner(ObjCorner corner, const ObjFile& file, SceneBuilder* builder) {
  auto beyond = [](std::int32_t index, std::size_t count) {
    return index >= 0 && static_cast<std::size_t>(index) >= count;
  };
  if (beyond(corner.position, file.positions.size() / 3))
    fail_import("a face uses vertex %d of %zu; export the file again", corner.position + 1, file.positions.size() / 3);
  const bool no_normal = beyond(corner.normal, file.normals.size() / 3), no_uv = beyond(corner.uv, file.uvs.size() / 2);
  if (no_normal || no_uv) note_remark(builder, "faces refer to missing normals or texture coordinates");
  if (no_normal) corner.normal = kNoElement;
  if (no_uv) corner.uv = kNoElement;
  return corner;
}

bool uses_uvs(const SceneBuilder& builder, std::uint32_t index) {
  const SceneArrays& out = *builder.out;
  const Material& material = out.materials[index];
  if (material.diffuse_texture.texture != kNone || material.emission_texture.texture != kNone) return true;
  return index < out.grains.size() && has_strength(out.grains[index]);
}

// `materials` maps the file's names to the scene's. `groups` receives the smoothing group of each triangle.
MeshData shape_mesh(const ObjShape& shape, const ObjFile& file, const std::vector<std::uint32_t>& materials,
                    CornerIndex* index, SceneBuilder* builder, std::vector<std::uint32_t>* groups) {
  MeshData mesh;
  mesh.name = "'" + shape.name.substr(0, 60) + "'";
  index->begin_mesh();
  bool normals = false, uvs = false, missing = false;
  auto material_of = [&](const ObjFace& face) {
    return materials[std::min<std::size_t>(face.material, materials.size() - 1)];
  };
  for (std::size_t f = shape.face_begin; f < shape.face_end; ++f) uvs |= uses_uvs(*builder, material_of(file.faces[f]));
  std::vector<ObjCorner> corners;
  for (std::size_t f = shape.face_begin; f < shape.face_end; ++f)
    for (std::uint32_t c = file.faces[f].corner_begin; c < file.faces[f].corner_end; ++c) {
      ObjCorner corner = checked_corner(file.corners[c], file, builder);
      normals |= corner.normal >= 0;
      missing |= uvs && corner.uv < 0;
      if (!uvs) corner.uv = kNoElement;
      corners.push_back(corner);
    }
  if (missing) note_remark(builder, "a mesh lacks texture coordinates, which its material uses");
  std::vector<std::uint32_t> vertices;
  std::size_t at = 0;
  for (std::size_t f = shape.face_begin; f < shape.face_end; ++f) {
    const ObjFace& face = file.faces[f];
    vertices.clear();
    for (std::uint32_t c = face.corner_begin; c < face.corner_end; ++c)
      vertices.push_back(index->vertex(corners[at++], normals, uvs, &mesh));
    append_polygon(vertices, &mesh, builder);
    mesh.triangle_materials.resize(mesh.indices.size() / 3, material_of(face));
    groups->resize(mesh.indices.size() / 3, face.group);
  }
  return mesh;
}

// Adds normals to a shape's mesh where the file has none.
void smooth(const ObjFile& file, const ObjSurfaces& surfaces, std::size_t shape, const CornerIndex& index,
            const std::vector<std::uint32_t>& groups, MeshData* mesh) {
  if (!mesh->normals.empty()) return;
  if (!file.has_groups) return smooth_normals(mesh, kCreaseDegrees);
  smooth_normals(mesh, kCreaseDegrees, &groups, [&](std::uint32_t vertex, std::uint32_t group) {
    const std::int32_t position = index.position(vertex);
    if (position == kNoElement) return Vec3d{0, 0, 0};
    return surfaces.normals_elsewhere(static_cast<std::size_t>(position), shape, group);
  });
}

// Returns the scene's materials by the file's names, followed by the one for faces without a name.
std::vector<std::uint32_t> find_materials(const ObjFile& file, const std::vector<MtlMaterial>& materials,
                                          std::uint32_t default_material, SceneBuilder* builder) {
  std::unordered_map<std::string, std::uint32_t> by_name;
  for (std::size_t i = 0; i < materials.size(); ++i) by_name.emplace(materials[i].name, static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> found;
  for (const std::string& name : file.material_names) {
    auto known = by_name.find(name);
    if (known == by_name.end()) known = by_name.find(name.substr(0, name.find_first_of(" \t")));
    if (known == by_name.end()) note_remark(builder, "faces without a known material got the default one");
    found.push_back(known == by_name.end() ? default_material : known->second);
  }
  found.push_back(default_material);
  return found;
}

// Returns the scene's origin in the file's coordinates; zero if the model is near it.
Vec3d choose_origin(const ObjFile& file, const Transform& turn, SceneBuilder* builder) {
  const std::size_t count = file.positions.size() / 3;
  const double* p = file.positions.data();
  ExactExtent extent;
  add_points(
      &extent, count,
      [&](std::size_t i) {
        return Vec3d{p[3 * i], p[3 * i + 1], p[3 * i + 2]};
      },
      exact(turn),
      2 * static_cast<double>(count));  // a mesh has two triangles per vertex
  return turned_back(turn, choose_origin(extent, builder));
}

}  // namespace

void import_obj(const std::string& path, Bytes bytes, SceneBuilder* builder) {
  require_bytes(*builder, bytes.size(), 8, "the OBJ text");
  tidy_obj_text(&bytes);
  const ObjFile file = read_obj_file(bytes, *builder);
  const Transform turn = upright(builder, UpAxis::y, "OBJ");
  const Vec3d origin = choose_origin(file, turn, builder);
  const std::vector<MtlMaterial> sources = MaterialFiles(path, builder).read(file);
  for (const MtlMaterial& source : sources) add_obj_material(builder, path, source);
  const std::uint32_t default_material = static_cast<std::uint32_t>(builder->out->materials.size());
  builder->out->materials.emplace_back();
  const std::vector<std::uint32_t> materials = find_materials(file, sources, default_material, builder);

  if (file.has_lines) note_unused(builder, "lines");
  if (file.has_points) note_unused(builder, "points");
  for (const std::string& statement : file.unknown) note_unused(builder, "'" + statement.substr(0, 40) + "'");
  CornerIndex index(file, origin);
  const ObjSurfaces surfaces(file);
  bool default_used = false;
  for (std::size_t s = 0; s < file.shapes.size(); ++s) {
    const ObjShape& shape = file.shapes[s];
    std::vector<std::uint32_t> groups;
    MeshData mesh = shape_mesh(shape, file, materials, &index, builder, &groups);
    for (std::uint32_t material : mesh.triangle_materials) default_used |= material == default_material;
    smooth(file, surfaces, s, index, groups, &mesh);
    tidy_mesh(&mesh);
    begin_part(builder, shape.name);
    append_mesh(builder, mesh, turn);
  }
  if (!default_used && default_material > 0) builder->out->materials.pop_back();
}

}  // namespace pocketray
