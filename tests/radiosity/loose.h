// Small scenes for the radiosity solver.
#pragma once
#include <memory>
#include <vector>

#include "session/radiosity_solver.h"
#include "support/generated_scene.h"

namespace pocketray {

// A scene of loose triangles.
struct Loose {
  std::vector<Vec3> positions, normals;  // normals: none, or one per vertex
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<Light> lights;
  Scene scene;
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::uint32_t n = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back(Triangle(n, n + 1, n + 2, 0));
  }
  const Scene& bind() {
    scene.positions = {positions.data(), static_cast<std::uint32_t>(positions.size())};
    scene.normals = {normals.data(), static_cast<std::uint32_t>(normals.size())};
    scene.triangles = {triangles.data(), static_cast<std::uint32_t>(triangles.size())};
    scene.materials = {materials.data(), static_cast<std::uint32_t>(materials.size())};
    scene.lights = {lights.data(), static_cast<std::uint32_t>(lights.size())};
    return scene;
  }
};

inline std::unique_ptr<TestRenderer> solving_renderer(const Scene& scene) {
  Settings settings;
  settings.width = settings.height = 4, settings.indirect = IndirectChoice::none;
  return make_renderer(scene, settings);
}

inline Status solve(const Scene& scene, std::uint32_t patches, RadiositySolution* solution) {
  auto test = solving_renderer(scene);
  RadiosityOptions options;
  options.patch_count = patches, options.threads = 2;
  return solve_radiosity(
      test->renderer.frame, options, [](double) { return true; }, solution);
}

}  // namespace pocketray
