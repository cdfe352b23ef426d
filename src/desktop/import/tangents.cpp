#include "desktop/import/tangents.h"

#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "base/check.h"
#include "base/fmath.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

using VertexKey = std::array<std::uint32_t, 8>;  // the bits of position, normal and texture coordinates

struct Sum {
  Vec3d tangent = {0, 0, 0};
  bool mirrored = false, unmirrored = false;
};

using Sums = std::map<VertexKey, Sum>;
// Map entry with three links and a colour, plus the heap's own word.
constexpr std::uint64_t kSumBytes = sizeof(Sums::value_type) + 5 * sizeof(void*);

VertexKey key_of(const SceneArrays& out, std::uint32_t vertex) {
  const Vec3 normal = out.normals.empty() ? Vec3{0, 0, 0} : out.normals[vertex];
  const Vec3& p = out.positions[vertex];
  const float numbers[8] = {p.x, p.y, p.z, normal.x, normal.y, normal.z, out.uvs[vertex].x, out.uvs[vertex].y};
  VertexKey key;
  static_assert(sizeof key == sizeof numbers, "same bits");
  std::memcpy(key.data(), numbers, sizeof numbers);
  return key;
}

double angle_between(const Vec3d& a, const Vec3d& b) {
  const Vec3d p = normalize(a), q = normalize(b);
  return is_zero(p) || is_zero(q) ? 0 : det_acos(dot(p, q));
}

// Returns the sum at a vertex, creating it if necessary.
Sum* sum_at(const SceneBuilder& builder, std::uint32_t vertex, Sums* sums) {
  const VertexKey key = key_of(*builder.out, vertex);
  const auto found = sums->find(key);
  if (found != sums->end()) return &found->second;
  require_bytes(builder, sums->size() + 1, kSumBytes, "the tangents");
  return &(*sums)[key];
}

void add_triangle(const SceneBuilder& builder, const Triangle& t, Sums* sums) {
  const SceneArrays& out = *builder.out;
  Vec3d p[3];
  double u[3], v[3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    p[i] = to_double(out.positions[t.vertex(i)]);
    u[i] = static_cast<double>(out.uvs[t.vertex(i)].x), v[i] = static_cast<double>(out.uvs[t.vertex(i)].y);
  }
  const double area = (u[1] - u[0]) * (v[2] - v[0]) - (v[1] - v[0]) * (u[2] - u[0]);
  const Vec3d face = normalize(cross(p[1] - p[0], p[2] - p[0]));
  if (area == 0 || is_zero(face)) return;
  const Vec3d along = ((p[1] - p[0]) * (v[2] - v[0]) - (p[2] - p[0]) * (v[1] - v[0])) * (area < 0 ? -1.0 : 1.0);
  for (std::uint32_t i = 0; i < 3; ++i) {
    Sum* sum = sum_at(builder, t.vertex(i), sums);
    (area < 0 ? sum->mirrored : sum->unmirrored) = true;
    Vec3d n = out.normals.empty() ? Vec3d{0, 0, 0} : normalize(to_double(out.normals[t.vertex(i)]));
    if (is_zero(n)) n = face;
    auto flat = [&](const Vec3d& way) { return way - n * dot(n, way); };
    const double angle = angle_between(flat(p[(i + 1) % 3] - p[i]), flat(p[(i + 2) % 3] - p[i]));
    sum->tangent += normalize(flat(along)) * angle;
  }
}

PackedTangent pack(const Vec3d& tangent, int handedness) {
  auto byte = [](double x) { return static_cast<std::int8_t>(std::floor(x * 127 + 0.5)); };
  return {byte(tangent.x), byte(tangent.y), byte(tangent.z), static_cast<std::int8_t>(handedness)};
}

bool is_given(const SceneArrays& out, std::uint32_t vertex) {
  return vertex < out.tangents.size() && !is_zero(unpacked(out.tangents[vertex]));
}

bool are_given(const SceneArrays& out, const Triangle& t) {
  return is_given(out, t.vertex(0)) && is_given(out, t.vertex(1)) && is_given(out, t.vertex(2));
}

}  // namespace

bool needs_tangents(const SceneArrays& out, std::uint32_t material) {
  if (material < out.grains.size() && has_strength(out.grains[material])) return true;
  if (material < out.clear_coats.size() && out.clear_coats[material].normal.texture != kNone) return true;
  return material < out.material_maps.size() && out.material_maps[material].normal.texture != kNone;
}

// A mirroring transform also mirrors the bitangent, but not the normal.
std::vector<PackedTangent> pack_tangents(const std::vector<GivenTangent>& given, const Transform& to_world) {
  const int side = determinant(to_world) < 0 ? -1 : 1;
  std::vector<PackedTangent> packed;
  packed.reserve(given.size());
  for (const GivenTangent& t : given) {
    CHECK(t.handedness == 1 || t.handedness == -1);
    packed.push_back(pack(normalize(to_double(transform_vector(to_world, t.direction))), t.handedness * side));
  }
  return packed;
}

void make_tangents(SceneBuilder* builder) {
  CHECK(builder != nullptr);
  SceneArrays* out = builder->out.get();
  Sums sums;
  for (const Triangle& t : out->triangles)
    if (needs_tangents(*out, t.material()) && !out->uvs.empty() && !are_given(*out, t))
      add_triangle(*builder, t, &sums);
  if (sums.empty() && out->tangents.empty()) return;
  charge_bytes(builder, (out->positions.size() - out->tangents.size()) * sizeof(PackedTangent), "the tangents");
  out->tangents.resize(out->positions.size());
  for (const Triangle& t : out->triangles)
    for (std::uint32_t i = 0; i < 3 && needs_tangents(*out, t.material()); ++i) {
      if (is_given(*out, t.vertex(i))) continue;
      const auto sum = sums.find(key_of(*out, t.vertex(i)));
      if (sum == sums.end() || (sum->second.mirrored && sum->second.unmirrored)) continue;
      out->tangents[t.vertex(i)] = pack(normalize(sum->second.tangent), 0);
    }
  for (const MovingMesh& mesh : out->moving_meshes)
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) out->tangents[mesh.vertex_begin + i] = PackedTangent();
}

}  // namespace pocketray
