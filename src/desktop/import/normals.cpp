#include "desktop/import/normals.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <unordered_map>

#include "base/check.h"
#include "base/fmath.h"
#include "desktop/import/obj_file.h"

namespace pocketray {
namespace {

// With more triangles than this around a position, averages all of them, because the pairwise test is quadratic.
constexpr std::size_t kValenceMax = 2048;
// Directions closer than this count as the same plane: a few roundings of unit vectors.
constexpr double kSameNormal = 4e-7;

struct Corner {
  Vec3d normal;  // of its triangle, unit or zero
  double angle;
  std::uint32_t group;
};

// For each vertex, the first vertex at the same position.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = positions[a], &q = positions[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  // NaN has no order; such vertices stay separate at the end.
  auto finite =
      std::stable_partition(order.begin(), order.end(), [&](std::uint32_t i) { return is_finite(positions[i]); });
  std::sort(order.begin(), finite, less);
  for (std::size_t i = 0; i < order.size(); ++i) {
    bool same = i > 0 && order.begin() + static_cast<std::ptrdiff_t>(i) < finite &&
                positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::vector<Corner> measure_corners(const MeshData& mesh, const std::vector<std::uint32_t>* groups) {
  std::vector<Corner> corners(mesh.indices.size());
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    Vec3d p[3];
    for (int k = 0; k < 3; ++k) p[k] = to_double(mesh.positions[mesh.indices[t + static_cast<std::size_t>(k)]]);
    const std::uint32_t group = groups ? (*groups)[t / 3] : kNoGroup;
    Vec3d normal = normalize(cross(normalize(p[1] - p[0]), normalize(p[2] - p[0])));
    for (int k = 0; k < 3; ++k) {
      Vec3d a = normalize(p[(k + 1) % 3] - p[k]), b = normalize(p[(k + 2) % 3] - p[k]);
      corners[t + static_cast<std::size_t>(k)] = {normal, det_acos(dot(a, b)), group};
    }
  }
  return corners;
}

bool is_other_plane(const Vec3d& normal, const Vec3d& own) {
  const Vec3d d = normal - own;
  return dot(d, d) > kSameNormal * kSameNormal && !is_zero(normal);
}

// Normal of a corner from all corners at its position and from normals elsewhere.
Vec3d corner_normal(const std::vector<Corner>& corners, std::uint32_t self, const std::uint32_t* around,
                    std::size_t count, double cos_crease, const Vec3d& elsewhere, bool* flat) {
  const Vec3d& own = corners[self].normal;
  const std::uint32_t group = corners[self].group;
  if (group == kFlatGroup) return own;
  Vec3d sum = elsewhere;
  if (is_other_plane(normalize(elsewhere), own)) *flat = false;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner& other = corners[around[i]];
    if (other.group != group) continue;
    if (group == kNoGroup && count <= kValenceMax && dot(own, other.normal) < cos_crease) continue;
    sum += other.normal * other.angle;
    if (is_other_plane(other.normal, own)) *flat = false;
  }
  Vec3d mean = normalize(sum);
  return is_zero(mean) ? own : mean;
}

// Splits vertices whose corners have different normals.
void assign(MeshData* mesh, const std::vector<Vec3>& normals) {
  MeshData old = *mesh;
  std::size_t count = old.positions.size();
  std::vector<std::uint32_t> head(count, kNone), next;
  std::vector<std::uint32_t> source;
  mesh->normals.clear();
  for (std::size_t c = 0; c < normals.size(); ++c) {
    std::uint32_t vertex = old.indices[c], found = head[vertex];
    while (found != kNone && mesh->normals[found] != normals[c]) found = next[found];
    if (found == kNone) {
      found = static_cast<std::uint32_t>(source.size());
      source.push_back(vertex);
      mesh->normals.push_back(normals[c]);
      next.push_back(head[vertex]);
      head[vertex] = found;
    }
    mesh->indices[c] = found;
  }
  auto regather = [&](auto* array, const auto& from) {
    if (from.empty()) return;
    array->clear();
    array->reserve(source.size());
    for (std::uint32_t i : source) array->push_back(from[i]);
  };
  regather(&mesh->positions, old.positions);
  regather(&mesh->uvs, old.uvs);
  regather(&mesh->second_uvs, old.second_uvs);
  regather(&mesh->tangents, old.tangents);
  regather(&mesh->colors, old.colors);
  regather(&mesh->skin_weights, old.skin_weights);
}

}  // namespace

void smooth_normals(MeshData* mesh, float crease_degrees, const std::vector<std::uint32_t>* groups,
                    const NormalsElsewhere& elsewhere) {
  CHECK(!groups || groups->size() == mesh->indices.size() / 3);
  std::vector<std::uint32_t> first = weld(mesh->positions);
  std::vector<Corner> corners = measure_corners(*mesh, groups);
  // Corners by position: counting sort.
  std::vector<std::uint32_t> begin(mesh->positions.size() + 1, 0), around(corners.size());
  for (std::uint32_t index : mesh->indices) ++begin[first[index] + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> cursor(begin.begin(), begin.end() - 1);
  for (std::uint32_t c = 0; c < corners.size(); ++c) around[cursor[first[mesh->indices[c]]]++] = c;

  double cos_crease = det_cos(radians(static_cast<double>(crease_degrees)));
  bool flat = true;
  std::vector<Vec3> normals(corners.size());
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    std::uint32_t position = first[mesh->indices[c]];
    const Vec3d more = elsewhere ? elsewhere(mesh->indices[c], corners[c].group) : Vec3d{0, 0, 0};
    normals[c] = to_float(corner_normal(corners, c, &around[begin[position]], begin[position + 1] - begin[position],
                                        cos_crease, more, &flat));
  }
  mesh->normals.clear();
  if (!flat) assign(mesh, normals);
}

}  // namespace pocketray
