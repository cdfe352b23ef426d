#include "desktop/import/ply_faces.h"

#include "desktop/import/import_error.h"
#include "desktop/import/polygon.h"

namespace pocketray {
namespace {

bool is_same(const Rgba16& a, const Rgba16& b) { return a.r == b.r && a.g == b.g && a.b == b.b && a.a == b.a; }

// Vertices by the file's vertex, colour and texture coordinates.
class DividedVertices {
 public:
  explicit DividedVertices(MeshData* mesh)
      : mesh_(*mesh), source_(std::move(*mesh)), head_(source_.positions.size(), kNone) {
    mesh_ = MeshData();
    mesh_.name = source_.name;
  }

  std::uint32_t find(std::uint32_t vertex, const Rgba16* color, const Vec2* uv) {
    const Rgba16 own = color ? *color : source_.colors.empty() ? kNoFaceColor : source_.colors[vertex];
    const Vec2 place = uv ? *uv : source_.uvs.empty() ? Vec2{0, 0} : source_.uvs[vertex];
    for (std::uint32_t at = head_[vertex]; at != kNone; at = next_[at])
      if (is_same(mesh_.colors[at], own) && mesh_.uvs[at].x == place.x && mesh_.uvs[at].y == place.y) return at;
    next_.resize(mesh_.positions.size(), kNone);  // vertices where polygons cross themselves are in no chain
    const std::uint32_t made = static_cast<std::uint32_t>(next_.size());
    next_.push_back(head_[vertex]);
    head_[vertex] = made;
    mesh_.positions.push_back(source_.positions[vertex]);
    if (!source_.normals.empty()) mesh_.normals.push_back(source_.normals[vertex]);
    mesh_.colors.push_back(own);
    mesh_.uvs.push_back(place);
    return made;
  }

 private:
  MeshData& mesh_;
  MeshData source_;
  std::vector<std::uint32_t> head_, next_;
};

}  // namespace

void append_faces(const PlyFaces& faces, MeshData* mesh, SceneBuilder* builder) {
  const bool divides = !faces.colors.empty() || !faces.uvs.empty();
  const bool has_colors = !faces.colors.empty() || !mesh->colors.empty(),
             has_uvs = !faces.uvs.empty() || !mesh->uvs.empty();
  for (std::uint32_t vertex : faces.corners)
    if (vertex >= mesh->positions.size())
      fail_import("a face uses vertex %u of %zu; export the file again", vertex, mesh->positions.size());
  if (divides) require_bytes(*builder, faces.corners.size(), 64, "the geometry");
  std::vector<std::uint32_t> vertices;
  auto append_all = [&](auto vertex_of) {
    std::size_t corner = 0;
    for (std::size_t f = 0; f < faces.ends.size(); ++f) {
      vertices.clear();
      for (; corner < faces.ends[f]; ++corner) vertices.push_back(vertex_of(f, corner));
      append_polygon(vertices, mesh, builder);
      if (!faces.textures.empty())
        mesh->triangle_materials.resize(mesh->indices.size() / 3, f < faces.textures.size() ? faces.textures[f] : 0);
    }
  };
  if (!divides) return append_all([&](std::size_t, std::size_t corner) { return faces.corners[corner]; });
  DividedVertices divided(mesh);
  append_all([&](std::size_t f, std::size_t corner) {
    return divided.find(faces.corners[corner], f < faces.colors.size() ? &faces.colors[f] : nullptr,
                        corner < faces.uvs.size() ? &faces.uvs[corner] : nullptr);
  });
  if (!has_colors) mesh->colors.clear();
  if (!has_uvs) mesh->uvs.clear();
}

}  // namespace pocketray
