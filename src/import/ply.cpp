#include "import/ply.h"

#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/color.h"
#include "base/limits.h"
#include "import/exact.h"
#include "import/import_error.h"
#include "import/normals.h"
#include "import/ply_file.h"

namespace pocketray {
namespace {

enum Slot { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRed, kGreen, kBlue, kAlpha, kSlotCount };

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
              {"diffuse_blue", kBlue}};

Slot slot_of(const PlyProperty& property) {
  if (property.count) return kSlotCount;
  for (const auto& row : kSlots)
    if (property.name == row.name) return row.slot;
  return kSlotCount;
}

// Integers count up to their type's largest value; floats up to 1.
double largest(const PlyType& type) {
  return type.is_float ? 1 : static_cast<double>((std::uint64_t(1) << (8 * type.bytes - type.is_signed)) - 1);
}

void skip_property(const PlyProperty& property, std::uint64_t element, PlyNumbers* numbers) {
  numbers->skip(*property.value, property.count ? numbers->next_count(*property.count, element) : 1);
}

// Three values from values[first] on, as floats.
Vec3 checked(const double* values, Slot first, double limit, const char* what, std::uint64_t vertex) {
  for (int i = first; i < first + 3; ++i)
    if (!(std::fabs(values[i]) <= limit))
      fail_import("the %s of vertex %llu is not finite or beyond %g; fix it or export the file again", what,
                  static_cast<unsigned long long>(vertex), limit);
  return {static_cast<float>(values[first]), static_cast<float>(values[first + 1]),
          static_cast<float>(values[first + 2])};
}

std::uint16_t to_16(double value) {
  return static_cast<std::uint16_t>((value > 0 ? value < 1 ? value : 1 : 0) * 65535 + 0.5);
}

void read_vertices(const PlyElement& element, SceneBuilder* builder, PlyNumbers* numbers, MeshData* mesh) {
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
  std::vector<Vec3d> exactly;
  constexpr double kFloatMax = static_cast<double>(std::numeric_limits<float>::max());
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double values[kSlotCount] = {};
    values[kAlpha] = 1;
    for (std::size_t p = 0; p < slots.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (slots[p] == kSlotCount)
        skip_property(property, i, numbers);
      else
        values[slots[p]] = numbers->next(*property.value) / (slots[p] < kRed ? 1 : largest(*property.value));
    }
    mesh->positions.push_back(checked(values, kX, static_cast<double>(kCoordinateMax), "position", i));
    exactly.push_back({values[kX], values[kY], values[kZ]});
    if (normals) mesh->normals.push_back(normalize(checked(values, kNormalX, kFloatMax, "normal", i)));
    if (!colors) continue;
    checked(values, kRed, kFloatMax, "colour", i);
    auto linear = [](double c) { return to_16(srgb_decode(c > 0 ? c < 1 ? c : 1 : 0)); };
    mesh->colors.push_back(
        {linear(values[kRed]), linear(values[kGreen]), linear(values[kBlue]), to_16(values[kAlpha])});
  }
  recentre(exactly, 2 * element.count, builder, &mesh->positions);  // a mesh has two triangles per vertex
}

// The vertices of a face or strip as they come, with kNone for the -1 that restarts a strip.
std::uint32_t next_vertex(const PlyType& type, const PlyHeader& header, bool strip, std::uint64_t element,
                          PlyNumbers* numbers) {
  double vertex = numbers->next(type);
  if (strip && vertex == -1) return kNone;
  if (!(vertex >= 0 && vertex < static_cast<double>(header.vertex_count)) || vertex != std::floor(vertex))
    fail_import("%s %llu of the PLY file uses vertex %g of %llu; export the file again", strip ? "strip" : "face",
                static_cast<unsigned long long>(element), vertex, static_cast<unsigned long long>(header.vertex_count));
  return static_cast<std::uint32_t>(vertex);
}

// A fan around the first corner.
void read_face(const PlyProperty& corners, const PlyHeader& header, std::uint64_t face, const SceneBuilder& builder,
               PlyNumbers* numbers, MeshData* mesh) {
  std::uint64_t count = numbers->next_count(*corners.count, face);
  require_bytes(builder, mesh->indices.size() + 3 * count, 4, "the faces");
  if (count == 0)
    fail_import("face %llu of the PLY file has no corners; remove it or export the file again",
                static_cast<unsigned long long>(face));
  std::uint32_t first = 0, last = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint32_t vertex = next_vertex(*corners.value, header, false, face, numbers);
    if (i >= 2) mesh->indices.insert(mesh->indices.end(), {first, last, vertex});
    if (i == 0) first = vertex;
    last = vertex;
  }
}

// Each vertex makes a triangle with the two before it; every second triangle turns the other way. Triangles with two
// equal vertices only connect parts of a strip.
void read_strip(const PlyProperty& corners, const PlyHeader& header, std::uint64_t strip, const SceneBuilder& builder,
                PlyNumbers* numbers, MeshData* mesh) {
  std::uint64_t count = numbers->next_count(*corners.count, strip), since_restart = 0;
  require_bytes(builder, mesh->indices.size() + 3 * count, 4, "the strips");
  std::uint32_t before = 0, last = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint32_t vertex = next_vertex(*corners.value, header, true, strip, numbers);
    if (vertex == kNone) {
      since_restart = 0;
      continue;
    }
    if (since_restart >= 2 && before != last && last != vertex && vertex != before) {
      bool even = since_restart % 2 == 0;
      mesh->indices.insert(mesh->indices.end(), {even ? before : last, even ? last : before, vertex});
    }
    before = last;
    last = vertex;
    ++since_restart;
  }
}

void read_surfaces(const PlyElement& element, const PlyHeader& header, SceneBuilder* builder, PlyNumbers* numbers,
                   MeshData* mesh) {
  bool strip = element.name == "tristrips";
  CHECK(strip || element.name == "face");
  auto is_corners = [](const PlyProperty& p) { return p.count && p.name.compare(0, 10, "vertex_ind") == 0; };
  for (const PlyProperty& property : element.properties)
    if (slot_of(property) == kRed) note_unused(builder, "colours of faces");
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const PlyProperty& property : element.properties) {
      if (!is_corners(property))
        skip_property(property, i, numbers);
      else if (strip)
        read_strip(property, header, i, *builder, numbers, mesh);
      else
        read_face(property, header, i, *builder, numbers, mesh);
    }
}

}  // namespace

void import_ply(const Bytes& bytes, SceneBuilder* builder) {
  PlyHeader header = read_ply_header(bytes);
  if (header.names_texture) note_unused(builder, "textures of PLY");
  PlyNumbers numbers(bytes, header);
  MeshData mesh;
  mesh.name = "the PLY file";
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    if (element.name == "vertex")
      read_vertices(element, builder, &numbers, &mesh);
    else if (element.name == "face" || element.name == "tristrips")
      read_surfaces(element, header, builder, &numbers, &mesh);
    else
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const PlyProperty& property : element.properties) skip_property(property, i, &numbers);
  }
  builder->out->materials.emplace_back();
  tidy_mesh(&mesh);
  if (mesh.normals.empty()) smooth_normals(&mesh, builder->options.crease_angle);
  append_mesh(builder, mesh, Transform());
}

}  // namespace pocketray
