#include "desktop/import/tangents.h"

#include <doctest/doctest.h>

#include <cmath>

#include "desktop/import/import_error.h"

using namespace pocketray;

namespace {

// A cylinder of `columns` columns about y, whose vertex normals are its own; u runs around it, v along it.
SceneArrays cylinder(int columns, bool smooth, bool mirrored_half = false) {
  SceneArrays out;
  out.materials.emplace_back();
  out.grains.push_back({{1, 0}, {}});
  for (int i = 0; i <= columns; ++i) {
    const float turn = 6.2831853f * static_cast<float>(i) / static_cast<float>(columns);
    const Vec3 n = {std::cos(turn), 0, -std::sin(turn)};
    for (float y : {0.0f, 1.0f}) {
      out.positions.push_back(n + Vec3{0, y, 0});
      if (smooth) out.normals.push_back(n);
      const int at = mirrored_half && 2 * i > columns ? columns - i : i;
      out.uvs.push_back({static_cast<float>(at), 1 - y});
    }
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(columns); ++i) {
    const std::uint32_t a = 2 * i;
    out.triangles.push_back(Triangle(a, a + 2, a + 3, 0));
    out.triangles.push_back(Triangle(a, a + 3, a + 1, 0));
  }
  return out;
}

void make_tangents_of(SceneArrays* arrays) {
  SceneBuilder builder;
  std::swap(*builder.out, *arrays);
  make_tangents(&builder);
  std::swap(*builder.out, *arrays);
}

}  // namespace

// Goal: tangents follow the curved surface, not its triangles: on a smooth cylinder they are perpendicular to normal
// and axis at every vertex. Method: closed form, to within the quantum of 1/127.
TEST_CASE("tangents_are_averaged_at_vertices") {
  SceneArrays out = cylinder(12, true);
  make_tangents_of(&out);
  REQUIRE(out.tangents.size() == out.positions.size());
  for (std::size_t i = 2; i + 2 < out.tangents.size(); ++i) {  // not at the seam, which has one triangle's alone
    const Vec3 t = unpacked(out.tangents[i]) / 127.0f, n = out.normals[i], expected = cross({0, 1, 0}, n);
    CHECK(length(t - expected) < 0.01f);
  }
}

// Goal: triangles count by the angle that they have at the vertex. Method: closed form: in a plane, a right angle with
// ∂P/∂u along x, and half of one with ∂P/∂u along (1, 1).
TEST_CASE("tangents_are_weighted_by_angle") {
  SceneArrays out;
  out.materials.emplace_back();
  out.grains.push_back({{1, 0}, {}});
  out.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
  out.uvs = {{0, 0}, {1, 0}, {0, 1}, {-1, 2}};
  out.triangles = {Triangle(0, 1, 2, 0), Triangle(0, 2, 3, 0)};
  make_tangents_of(&out);
  const Vec3 expected = normalize(Vec3{2, 0, 0} + normalize(Vec3{1, 1, 0}));
  CHECK(length(unpacked(out.tangents[0]) / 127.0f - expected) < 0.01f);
}

// Goal: no vertex gets a tangent where nothing asks for one, that moves, or that both orientations of the texture
// share.
TEST_CASE("tangents_are_left_out") {
  SceneArrays plain = cylinder(6, true);
  plain.grains.clear();
  make_tangents_of(&plain);
  CHECK(plain.tangents.empty());
  SceneArrays moving = cylinder(6, true);
  MovingMesh mesh = {};
  mesh.vertex_begin = 2, mesh.vertex_count = 3;
  moving.moving_meshes.push_back(mesh);
  make_tangents_of(&moving);
  for (std::size_t i = 0; i < moving.tangents.size(); ++i)
    CHECK(is_zero(unpacked(moving.tangents[i])) == (i >= 2 && i < 5));
  SceneArrays folded = cylinder(6, true, true);
  make_tangents_of(&folded);
  for (std::size_t i = 0; i < folded.tangents.size(); ++i)
    CHECK(is_zero(unpacked(folded.tangents[i])) == (i == 6 || i == 7));
}

// Goal: meshes of normal maps get them, too; vertices of the same place count as one. Method: the triangles of a flat
// cylinder parted: their shared tangents stay those of the whole.
TEST_CASE("tangents_join_vertices_of_the_same_place") {
  SceneArrays out = cylinder(8, true), parted = out;
  parted.grains.clear(), parted.material_maps.emplace_back(), parted.material_maps[0].normal.texture = 0;
  parted.positions.clear(), parted.normals.clear(), parted.uvs.clear(), parted.triangles.clear();
  for (const Triangle& t : out.triangles) {
    const auto first = static_cast<std::uint32_t>(parted.positions.size());
    for (std::uint32_t i = 0; i < 3; ++i) {
      parted.positions.push_back(out.positions[t.vertex(i)]), parted.normals.push_back(out.normals[t.vertex(i)]);
      parted.uvs.push_back(out.uvs[t.vertex(i)]);
    }
    parted.triangles.push_back(Triangle(first, first + 1, first + 2, 0));
  }
  make_tangents_of(&out), make_tangents_of(&parted);
  for (std::size_t t = 0; t < out.triangles.size(); ++t)
    for (std::uint32_t i = 0; i < 3; ++i)
      CHECK(unpacked(out.tangents[out.triangles[t].vertex(i)]) ==
            unpacked(parted.tangents[parted.triangles[t].vertex(i)]));
}

// Goal: tangents and the memory to make them count towards the limit of the import. Method: limits from nothing upward
// admit the whole only where a node for every vertex fits, each at least its data.
TEST_CASE("tangents_stay_within_the_import_limit") {
  const std::size_t vertex_count = cylinder(500, true).positions.size();
  std::uint64_t admitted = 0;
  for (std::uint64_t limit = 1000; admitted == 0 && limit < 1u << 20; limit += 1000) {
    SceneBuilder builder;
    *builder.out = cylinder(500, true);
    builder.options.byte_count_max = limit;
    ImportedScene result;
    try {
      finish_scene(&builder, "a", &result);
      admitted = limit;
      CHECK(builder.bytes_charged == vertex_count * sizeof(PackedTangent));
    } catch (const ImportError& error) {
      CHECK(std::string(error.what()) == "the tangents would take the scene beyond 0 MiB; use a smaller model");
    }
  }
  CHECK(admitted >= vertex_count * (32 + 26 + sizeof(PackedTangent)));  // a vertex's bits, and their sum
  CHECK(admitted < vertex_count * 200);
}
