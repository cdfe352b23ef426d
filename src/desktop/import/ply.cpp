#include "desktop/import/ply.h"

#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/color.h"
#include "base/limits.h"
#include "desktop/import/image.h"
#include "desktop/import/import_error.h"
#include "desktop/import/normals.h"
#include "desktop/import/obj_lookup.h"
#include "desktop/import/origin.h"
#include "desktop/import/ply_faces.h"
#include "desktop/import/ply_file.h"
#include "desktop/import/upright.h"

namespace pocketray {
namespace {

enum Slot { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRed, kGreen, kBlue, kAlpha, kU, kV, kSlotCount };

constexpr struct {
  const char* name;
  Slot slot;
} kSlots[] = {{"x", kX},
              {"y", kY},
              {"z", kZ},
              {"nx", kNormalX},
              {"ny", kNormalY},
              {"nz", kNormalZ},
              {"red", kRed},
              {"green", kGreen},
              {"blue", kBlue},
              {"alpha", kAlpha},
              {"r", kRed},
              {"g", kGreen},
              {"b", kBlue},
              {"a", kAlpha},
              {"diffuse_red", kRed},
              {"diffuse_green", kGreen},
              {"diffuse_blue", kBlue},
              {"s", kU},
              {"t", kV},
              {"u", kU},
              {"v", kV},
              {"texture_u", kU},
              {"texture_v", kV},
              {"texture_s", kU},
              {"texture_t", kV}};

Slot slot_of(const PlyProperty& property) {
  if (property.count) return kSlotCount;
  for (const auto& row : kSlots)
    if (property.name == row.name) return row.slot;
  return kSlotCount;
}

// Integer types use their largest value; floats 1.
double largest(const PlyType& type) {
  return type.is_float ? 1 : static_cast<double>((std::uint64_t(1) << (8 * type.bytes - type.is_signed)) - 1);
}

void skip_property(const PlyProperty& property, std::uint64_t element, PlyNumbers* numbers) {
  numbers->skip(*property.value, property.count ? numbers->next_count(*property.count, element) : 1);
}

constexpr double kFloatMax = static_cast<double>(std::numeric_limits<float>::max());

// Returns three values from values[first] on, as floats. With `strict`, throws for one beyond the limit.
Vec3 checked(const double* values, Slot first, double limit, const char* what, std::uint64_t vertex, bool strict) {
  for (int i = first; i < first + 3; ++i)
    if (strict && !(std::fabs(values[i]) <= limit))
      fail_import("the %s of vertex %llu is not finite or beyond %g; fix it or export the file again", what,
                  static_cast<unsigned long long>(vertex), limit);
  return {static_cast<float>(values[first]), static_cast<float>(values[first + 1]),
          static_cast<float>(values[first + 2])};
}

Vec2 checked_uv(double u, double v) {
  const bool is_valid =
      std::fabs(u) <= static_cast<double>(kCoordinateMax) && std::fabs(v) <= static_cast<double>(kCoordinateMax);
  return is_valid ? Vec2{static_cast<float>(u), static_cast<float>(1 - v)} : Vec2{0, 0};  // v runs upward in PLY
}

std::uint16_t to_16(double value) {
  return static_cast<std::uint16_t>((value > 0 ? value < 1 ? value : 1 : 0) * 65535 + 0.5);
}

Rgba16 color_of(const double* values) {
  auto linear = [](double c) { return to_16(srgb_decode(c > 0 ? c < 1 ? c : 1 : 0)); };
  return {linear(values[kRed]), linear(values[kGreen]), linear(values[kBlue]), to_16(values[kAlpha])};
}

// Scales a number for its slot: colours to 0 to 1.
double slot_value(const PlyProperty& property, Slot slot, PlyNumbers* numbers) {
  const bool is_color = slot >= kRed && slot <= kAlpha;
  return numbers->next(*property.value) / (is_color ? largest(*property.value) : 1);
}

void read_vertices(const PlyElement& element, const Transform& turn, SceneBuilder* builder, PlyNumbers* numbers,
                   MeshData* mesh) {
  if (!mesh->positions.empty()) fail_import("the PLY file has two vertex elements; export the file again");
  require_bytes(*builder, element.count, 64, "the geometry");
  bool has[kSlotCount + 1] = {};
  std::vector<Slot> slots;
  for (const PlyProperty& property : element.properties) {
    slots.push_back(slot_of(property));
    has[slots.back()] = true;
  }
  if (!has[kX] || !has[kY] || !has[kZ]) fail_import("the PLY file has vertices without x, y, z; export the file again");
  bool normals = has[kNormalX] && has[kNormalY] && has[kNormalZ], colors = has[kRed] && has[kGreen] && has[kBlue];
  const bool uvs = has[kU] && has[kV], strict = builder->options.strict;
  std::vector<Vec3d> exactly;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double values[kSlotCount] = {};
    values[kAlpha] = 1;
    for (std::size_t p = 0; p < slots.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (slots[p] == kSlotCount)
        skip_property(property, i, numbers);
      else
        values[slots[p]] = slot_value(property, slots[p], numbers);
    }
    mesh->positions.push_back(checked(values, kX, static_cast<double>(kCoordinateMax), "position", i, strict));
    exactly.push_back({values[kX], values[kY], values[kZ]});
    if (normals) {
      const Vec3 normal = normalize(checked(values, kNormalX, kFloatMax, "normal", i, strict));
      mesh->normals.push_back(is_finite(normal) ? normal : Vec3{0, 0, 0});
    }
    if (uvs) mesh->uvs.push_back(checked_uv(values[kU], values[kV]));
    if (!colors) continue;
    checked(values, kRed, kFloatMax, "colour", i, strict);
    mesh->colors.push_back(color_of(values));
  }
  recentre(exactly, turn, 2 * static_cast<double>(element.count), builder,
           &mesh->positions);  // a mesh has two triangles per vertex
}

// Returns the next vertex of a face or strip, with kNone for the -1 that restarts a strip.
std::uint32_t next_vertex(const PlyType& type, const PlyHeader& header, bool strip, std::uint64_t element,
                          PlyNumbers* numbers) {
  double vertex = numbers->next(type);
  if (strip && vertex == -1) return kNone;
  if (!(vertex >= 0 && vertex < static_cast<double>(header.vertex_count)) || vertex != std::floor(vertex))
    fail_import("%s %llu of the PLY file uses vertex %g of %llu; export the file again", strip ? "strip" : "face",
                static_cast<unsigned long long>(element), vertex, static_cast<unsigned long long>(header.vertex_count));
  return static_cast<std::uint32_t>(vertex);
}

void read_face(const PlyProperty& corners, const PlyHeader& header, std::uint64_t face, const SceneBuilder& builder,
               PlyNumbers* numbers, PlyFaces* faces) {
  const std::uint64_t count = numbers->next_count(*corners.count, face);
  require_bytes(builder, faces->corners.size() + 3 * count, 8, "the faces");
  if (count == 0)
    fail_import("face %llu of the PLY file has no corners; remove it or export the file again",
                static_cast<unsigned long long>(face));
  for (std::uint64_t i = 0; i < count; ++i)
    faces->corners.push_back(next_vertex(*corners.value, header, false, face, numbers));
}

// Each vertex makes a triangle with the two before it; every second triangle is reversed. Triangles with two equal
// vertices only connect parts of a strip.
void read_strip(const PlyProperty& corners, const PlyHeader& header, std::uint64_t strip, const SceneBuilder& builder,
                PlyNumbers* numbers, PlyFaces* faces) {
  std::uint64_t count = numbers->next_count(*corners.count, strip), since_restart = 0;
  require_bytes(builder, faces->corners.size() + 3 * count, 8, "the strips");
  std::uint32_t before = 0, last = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint32_t vertex = next_vertex(*corners.value, header, true, strip, numbers);
    if (vertex == kNone) {
      since_restart = 0;
      continue;
    }
    if (since_restart >= 2 && before != last && last != vertex && vertex != before) {
      bool even = since_restart % 2 == 0;
      faces->corners.insert(faces->corners.end(), {even ? before : last, even ? last : before, vertex});
      end_face(faces);
    }
    before = last;
    last = vertex;
    ++since_restart;
  }
}

// Reads a list of numbers, or the single number of a property without a count.
std::vector<double> read_list(const PlyProperty& property, std::uint64_t element, const SceneBuilder& builder,
                              PlyNumbers* numbers) {
  const std::uint64_t count = property.count ? numbers->next_count(*property.count, element) : 1;
  require_bytes(builder, count, sizeof(double), "a list");
  std::vector<double> values;
  for (std::uint64_t i = 0; i < count; ++i) values.push_back(numbers->next(*property.value));
  return values;
}

void read_faces(const PlyElement& element, const PlyHeader& header, SceneBuilder* builder, PlyNumbers* numbers,
                PlyFaces* faces) {
  bool has[kSlotCount + 1] = {};
  for (const PlyProperty& property : element.properties) has[slot_of(property)] = true;
  const bool colors = has[kRed] && has[kGreen] && has[kBlue];
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double values[kSlotCount + 1] = {};
    values[kAlpha] = 1;
    const std::size_t begin = faces->corners.size();
    std::vector<double> uvs;
    double texture = 0;
    for (const PlyProperty& property : element.properties) {
      const Slot slot = slot_of(property);
      if (property.count && property.name.compare(0, 10, "vertex_ind") == 0)
        read_face(property, header, i, *builder, numbers, faces);
      else if (property.count && property.name == "texcoord")
        uvs = read_list(property, i, *builder, numbers);
      else if (!property.count && property.name == "texnumber")
        texture = numbers->next(*property.value);
      else if (colors && slot >= kRed && slot <= kAlpha)
        values[slot] = slot_value(property, slot, numbers);
      else
        skip_property(property, i, numbers);
    }
    const std::size_t count = faces->corners.size() - begin;
    if (count < 1) continue;
    if (colors) faces->colors.resize(faces->ends.size(), kNoFaceColor), faces->colors.push_back(color_of(values));
    if (texture > 0 && texture < static_cast<double>(header.textures.size())) {
      faces->textures.resize(faces->ends.size(), 0);
      faces->textures.push_back(static_cast<std::uint32_t>(texture));
    }
    if (uvs.size() == 2 * count) {
      faces->uvs.resize(begin, Vec2{0, 0});
      for (std::size_t k = 0; k < uvs.size(); k += 2) faces->uvs.push_back(checked_uv(uvs[k], uvs[k + 1]));
    }
    end_face(faces);
  }
}

void read_strips(const PlyElement& element, const PlyHeader& header, const SceneBuilder& builder, PlyNumbers* numbers,
                 PlyFaces* faces) {
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const PlyProperty& property : element.properties)
      if (property.count && property.name.compare(0, 10, "vertex_ind") == 0)
        read_strip(property, header, i, builder, numbers, faces);
      else
        skip_property(property, i, numbers);
}

// Adds a material per texture named in the header, or one without a texture.
std::uint32_t add_materials(const std::string& path, const PlyHeader& header, SceneBuilder* builder) {
  std::uint32_t loaded = 0;
  for (const std::string& name : header.textures) {
    Material material;
    try {
      std::string found;
      Image image =
          decode_image(builder, read_named({path}, name, builder->options.byte_count_max, builder, &found), name);
      material.diffuse_texture.texture =
          add_texture(builder, add_texels(builder, std::move(image)), Wrap::repeat, Wrap::repeat, false);
      material.diffuse = {1, 1, 1};
      ++loaded;
    } catch (const ImportError& error) {
      note_remark(builder, std::string("a texture is missing: ") + error.what());
    }
    add_material(builder, material, name);
  }
  if (header.textures.empty()) builder->out->materials.emplace_back();
  return loaded;
}

}  // namespace

void import_ply(const std::string& path, const Bytes& bytes, SceneBuilder* builder) {
  const PlyHeader header = read_ply_header(bytes);
  const Transform turn = upright(builder, header.is_upright ? UpAxis::y : UpAxis::z, "PLY");
  PlyNumbers numbers(bytes, header);
  MeshData mesh;
  mesh.name = "the PLY file";
  PlyFaces faces;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    if (element.name == "vertex")
      read_vertices(element, turn, builder, &numbers, &mesh);
    else if (element.name == "face")
      read_faces(element, header, builder, &numbers, &faces);
    else if (element.name == "tristrips")
      read_strips(element, header, *builder, &numbers, &faces);
    else
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const PlyProperty& property : element.properties) skip_property(property, i, &numbers);
  }
  if (faces.ends.empty() && !mesh.positions.empty())
    fail_import("%zu points without faces; make a mesh of them, for example by MeshLab's surface reconstruction",
                mesh.positions.size());
  const bool is_textured = add_materials(path, header, builder) > 0;
  if (!is_textured) mesh.uvs.clear(), faces.uvs.clear();
  if (is_textured && mesh.uvs.empty() && faces.uvs.empty())
    note_remark(builder, "the PLY file names a texture and has no texture coordinates");
  append_faces(faces, &mesh, builder);
  tidy_mesh(&mesh);
  if (mesh.normals.empty()) smooth_normals(&mesh, kCreaseDegrees);
  append_mesh(builder, mesh, turn);
}

}  // namespace pocketray
