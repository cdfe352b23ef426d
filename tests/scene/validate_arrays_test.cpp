// Large arrays, which validate_scene() scans several elements at a time: a fault anywhere is found and named.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/rng.h"
#include "scene/baked.h"
#include "scene/refusals.h"

using namespace pocketray;

namespace {

// A mesh with normals and two sets of texture coordinates, and materials.
struct Arrays {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs, second_uvs;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  Scene scene;

  Arrays(std::uint32_t vertex_count, std::uint32_t triangle_count, std::uint32_t material_count) {
    Rng rng = make_rng(701);
    for (std::uint32_t i = 0; i < vertex_count; ++i) {
      auto random = [&] { return next_float(&rng) - 0.5f; };
      positions.push_back({random(), 1 + random(), random()});
      normals.push_back(i % 10 == 7 ? Vec3{0, 0, 0} : normalize(positions.back()));
      uvs.push_back({random(), random()});
    }
    second_uvs = uvs;
    for (std::uint32_t i = 0; i < triangle_count; ++i) {
      const std::uint32_t a = next_u32(&rng) % vertex_count, b = next_u32(&rng) % vertex_count;
      triangles.emplace_back(a, b, vertex_count - 1, next_u32(&rng) % material_count);
    }
    materials.resize(material_count);
    bind();
  }
  void bind() {
    auto view = [](const auto& v, auto* array) { *array = {v.data(), static_cast<std::uint32_t>(v.size())}; };
    view(positions, &scene.positions), view(normals, &scene.normals), view(uvs, &scene.uvs);
    view(second_uvs, &scene.second_uvs), view(triangles, &scene.triangles), view(materials, &scene.materials);
  }
  // The message of validating the scene with one value replaced.
  template <class T>
  std::string with(T* value, T replaced) {
    std::swap(*value, replaced);
    const Status status = validate_scene(scene);
    std::swap(*value, replaced);
    return status.ok ? "" : status.message;
  }
};

bool names(const std::string& message, const char* array, std::uint32_t i) {
  CAPTURE(message);
  return message.find(array + ("[" + std::to_string(i) + "] ")) == 0 && message.find('\n') == std::string::npos;
}

}  // namespace

// Goal: every coordinate is looked at, in arrays of every remainder of the steps of scans. Method: each element in
// turn.
TEST_CASE("validate_names_each_faulty_vertex") {
  for (std::uint32_t count : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 15u, 16u, 17u, 66u}) {
    Arrays a(count, 5, 1);
    REQUIRE_MESSAGE(validate_scene(a.scene).ok, validate_scene(a.scene).message);
    for (std::uint32_t i = 0; i < count; ++i)
      for (float bad : {kNan, -kInf, 1.0001e18f, -2e18f}) {
        CHECK(names(a.with(&a.positions[i][static_cast<int>(i % 3)], bad), "positions", i));
        CHECK(names(a.with(&a.normals[i][static_cast<int>((i + 1) % 3)], bad), "normals", i));
        CHECK(names(a.with(&a.uvs[i].x, bad), "uvs", i));
        CHECK(names(a.with(&a.second_uvs[i].y, bad), "second_uvs", i));
      }
    for (std::uint32_t i = 0; i < count; ++i)
      for (const Vec3& bad : {Vec3{0, 0, 1.02f}, Vec3{0.7f, 0, 0.6f}, Vec3{1e-3f, 0, 0}, Vec3{1e-45f, 0, 0}})
        CHECK(names(a.with(&a.normals[i], bad), "normals", i));
  }
}

// Goal: no index out of range passes, whatever the others are. Method: each triangle, each corner; numbers of materials
// that fill one, two and three shares of a triangle's words.
TEST_CASE("validate_names_each_faulty_triangle") {
  for (std::uint32_t material_count : {1u, 2u, 63u, 64u, 65u, 99u, 130u, 4100u}) {
    CAPTURE(material_count);
    Arrays a(9, 50, material_count);
    REQUIRE_MESSAGE(validate_scene(a.scene).ok, validate_scene(a.scene).message);
    for (std::uint32_t i = 0; i < 50; ++i) {
      for (std::uint32_t corner = 0; corner < 3; ++corner)
        for (std::uint32_t vertex : {9u, kVertexCountMax - 1}) {
          Triangle t = a.triangles[i];
          t.set_vertex(corner, vertex);
          CHECK(names(a.with(&a.triangles[i], t), "triangles", i));
        }
      for (std::uint32_t material : {material_count, kMaterialCountMax - 1}) {
        Triangle t = a.triangles[i];
        t.set_material(material);
        CHECK(names(a.with(&a.triangles[i], t), "triangles", i));
      }
    }
  }
  Arrays none(3, 2, 1);
  none.materials.clear(), none.bind();
  CHECK(names(validate_scene(none.scene).message, "triangles", 0));
}
