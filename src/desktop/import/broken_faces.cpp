#include "desktop/import/broken_faces.h"

#include <algorithm>

#include "base/check.h"
#include "base/limits.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

// Removes the triangles with a broken vertex. Indices out of range are left to tidy_mesh().
void remove_faces(const std::vector<bool>& is_broken, MeshData* mesh, SceneBuilder* builder) {
  const bool has_materials = !mesh->triangle_materials.empty();
  CHECK_EQ(mesh->indices.size() % 3, 0u);
  CHECK(!has_materials || mesh->triangle_materials.size() == mesh->indices.size() / 3);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh->indices.size() / 3; ++t) {
    const auto first = mesh->indices.begin() + static_cast<std::ptrdiff_t>(3 * t);
    if (std::any_of(first, first + 3, [&](std::uint32_t v) { return v < is_broken.size() && is_broken[v]; })) continue;
    std::copy(first, first + 3, mesh->indices.begin() + static_cast<std::ptrdiff_t>(3 * kept));
    if (has_materials) mesh->triangle_materials[kept] = mesh->triangle_materials[t];
    ++kept;
  }
  builder->broken_face_count += mesh->indices.size() / 3 - kept;
  mesh->indices.resize(3 * kept);
  if (has_materials) mesh->triangle_materials.resize(kept);
}

}  // namespace

bool is_coordinate(const Vec3& p) {
  return std::fabs(p.x) <= kCoordinateMax && std::fabs(p.y) <= kCoordinateMax && std::fabs(p.z) <= kCoordinateMax;
}

void require_finite(const Vec3& p, const std::string& mesh_name, const SceneBuilder& builder) {
  if (builder.options.strict && !is_coordinate(p))
    fail_import("%.100s: a vertex is at (%g, %g, %g), not finite or beyond %g; scale the model down", mesh_name.c_str(),
                static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z),
                static_cast<double>(kCoordinateMax));
}

void leave_out_broken_faces(MeshData* mesh, SceneBuilder* builder) {
  const std::size_t count = mesh->positions.size();
  CHECK_EQ(mesh->morph_positions.size(), mesh->morph_count * count);
  std::vector<bool> is_broken(count);
  for (std::size_t v = 0; v < count; ++v) is_broken[v] = !is_coordinate(mesh->positions[v]);
  for (std::size_t i = 0; i < mesh->morph_positions.size(); ++i)
    if (!is_coordinate(mesh->morph_positions[i])) is_broken[i % count] = true;
  remove_faces(is_broken, mesh, builder);
}

const MeshData& without_broken_faces(const MeshData& mesh, const std::vector<Vec3>& placed, SceneBuilder* builder,
                                     MeshData* kept) {
  CHECK_EQ(placed.size(), mesh.positions.size());
  if (std::all_of(placed.begin(), placed.end(), is_coordinate)) return mesh;
  *kept = mesh;
  std::vector<bool> is_broken(placed.size());
  for (std::size_t v = 0; v < placed.size(); ++v) {
    require_finite(placed[v], mesh.name, *builder);
    is_broken[v] = !is_coordinate(placed[v]);
  }
  remove_faces(is_broken, kept, builder);
  tidy_mesh(kept);
  return *kept;
}

}  // namespace pocketray
