// The statue at full resolution, on a round pedestal in front of a niche between two fluted columns; as many triangles
// as the Buddha of [Aranha07] sec. 4. Units: one head of the figure.
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/figure.h"
#include "scene/builtin/mesh_writer.h"
#include "scene/builtin/scene_parts.h"

namespace pocketray {
namespace {

constexpr FigureDetail kFigure = {137, 206, 39, 42, 30};

// Profiles: (radius, height), from the ground up.
constexpr Vec2 kPedestal[] = {{2.05f, 0},     {2.05f, .22f}, {1.9f, .22f},   {1.86f, .32f}, {1.72f, .38f}, {1.6f, .5f},
                              {1.56f, 1.42f}, {1.66f, 1.5f}, {1.78f, 1.55f}, {1.8f, 1.7f},  {0, 1.7f}};
constexpr Vec2 kColumnBase[] = {{1.2f, 0}, {1.2f, .3f}, {1.1f, .42f}, {1.0f, .46f}, {1.02f, .6f}, {.9f, .7f}};
constexpr std::uint32_t kPedestalPoints = sizeof kPedestal / sizeof *kPedestal, kPedestalColumns = 72;
constexpr std::uint32_t kBasePoints = sizeof kColumnBase / sizeof *kColumnBase, kBaseColumns = 48;

// A shaft without ends, four strips per flute.
constexpr std::uint32_t kFlutes = 20, kShaftColumns = 4 * kFlutes, kShaftRows = 6;
constexpr MeshSize kShaftSize = {kShaftColumns * kShaftRows, 2 * kShaftColumns*(kShaftRows - 1)};

// A niche (half a cylinder under a quarter sphere) and the wall around it: two sides and the part above.
constexpr std::uint32_t kNicheColumns = 48, kDomeRows = 12;
constexpr MeshSize kNicheSize = {(kNicheColumns + 1) * (kDomeRows + 1) + 1, kNicheColumns*(2 * kDomeRows + 1)};
constexpr MeshSize kWallSize = 2 * MeshSize{2 * (kDomeRows + 2), 2 * (kDomeRows + 1)} + quad_size();
constexpr float kNicheRadius = 3.1f, kNicheHeight = 7.6f, kWallZ = -1.6f, kWallHalf = 9, kWallTop = 13;

constexpr MeshSize kSize = figure_size(kFigure) + lathe_size(kPedestalColumns, kPedestalPoints, 1) +
                           2 * (lathe_size(kBaseColumns, kBasePoints, 0) + kShaftSize) + kNicheSize + kWallSize +
                           quad_size();
static_assert(kSize.triangles == 67244, "[Aranha07] sec. 4");

enum MaterialIndex : std::uint32_t { kMarble, kStone, kPlaster, kFloor, kMaterialCount };

void add_shaft(MeshWriter* mesh, const Vec3& foot, float height) {
  std::uint32_t first = mesh->vertex_count, first_triangle = mesh->triangle_count;
  for (std::uint32_t row = 0; row < kShaftRows; ++row) {
    float t = static_cast<float>(row) / (kShaftRows - 1);
    float radius = .84f - .07f * t * t;  // entasis
    for (std::uint32_t column = 0; column < kShaftColumns; ++column) {
      constexpr float kHollow[4] = {0, .055f, .075f, .055f};
      double azimuth = 2 * kPi * column / kShaftColumns;
      float r = radius - kHollow[column % 4];
      Vec3 at = {r * static_cast<float>(det_sin(azimuth)), t * height, r * static_cast<float>(det_cos(azimuth))};
      add_vertex(mesh, foot + at, {0, 0, 0});
    }
  }
  for (std::uint32_t row = 0; row + 1 < kShaftRows; ++row) {
    for (std::uint32_t column = 0; column < kShaftColumns; ++column) {
      std::uint32_t a = first + row * kShaftColumns + column;
      std::uint32_t b = first + row * kShaftColumns + (column + 1) % kShaftColumns;
      add_triangle(mesh, a, b, b + kShaftColumns);
      add_triangle(mesh, a, b + kShaftColumns, a + kShaftColumns);
    }
  }
  smooth_normals(mesh, first, first_triangle);
}

void add_niche(MeshWriter* mesh) {
  std::uint32_t first = mesh->vertex_count, first_triangle = mesh->triangle_count;
  constexpr std::uint32_t kStride = kNicheColumns + 1;
  for (std::uint32_t row = 0; row <= kDomeRows; ++row) {  // row 0 on the floor, row 1 where the dome starts
    double latitude = row == 0 ? 0 : kPi / 2 * (row - 1) / kDomeRows;
    float ring = kNicheRadius * static_cast<float>(det_cos(latitude));
    float y = row == 0 ? 0 : kNicheHeight + kNicheRadius * static_cast<float>(det_sin(latitude));
    for (std::uint32_t column = 0; column <= kNicheColumns; ++column) {
      double azimuth = kPi * column / kNicheColumns;  // from -x through -z to +x
      float x = -ring * static_cast<float>(det_cos(azimuth));
      float z = column == 0 || column == kNicheColumns ? 0 : -ring * static_cast<float>(det_sin(azimuth));
      add_vertex(mesh, {x, y, kWallZ + z}, {0, 0, 0});
    }
  }
  std::uint32_t pole = add_vertex(mesh, {0, kNicheHeight + kNicheRadius, kWallZ}, {0, 0, 0});
  for (std::uint32_t row = 0; row <= kDomeRows; ++row) {
    for (std::uint32_t column = 0; column < kNicheColumns; ++column) {
      std::uint32_t a = first + row * kStride + column;
      if (row == kDomeRows) {
        add_triangle(mesh, a, a + 1, pole);
      } else {
        add_triangle(mesh, a, a + 1, a + 1 + kStride);
        add_triangle(mesh, a, a + 1 + kStride, a + kStride);
      }
    }
  }
  smooth_normals(mesh, first, first_triangle);

  for (std::uint32_t side = 0; side < 2; ++side) {
    std::uint32_t strip = mesh->vertex_count;
    for (std::uint32_t row = 0; row <= kDomeRows + 1; ++row) {
      Vec3 edge = mesh->positions[row > kDomeRows ? pole : first + row * kStride + side * kNicheColumns];
      Vec3 outer = {side ? kWallHalf : -kWallHalf, edge.y, edge.z};
      add_vertex(mesh, side ? edge : outer, {0, 0, 1});
      add_vertex(mesh, side ? outer : edge, {0, 0, 1});
    }
    for (std::uint32_t a = strip; a + 2 < mesh->vertex_count; a += 2) {
      add_triangle(mesh, a, a + 1, a + 3);
      add_triangle(mesh, a, a + 3, a + 2);
    }
  }
  const float top = kNicheHeight + kNicheRadius;
  add_quad(mesh, {-kWallHalf, top, kWallZ}, {kWallHalf, top, kWallZ}, {kWallHalf, kWallTop, kWallZ},
           {-kWallHalf, kWallTop, kWallZ});
}

}  // namespace

std::size_t statue_need() { return mesh_need(kSize) + parts_need(kMaterialCount, 3, 1); }

void build_statue(Arena* arena, Scene* scene) {
  name_scene(scene, "statue");
  MeshWriter mesh = make_mesh(arena, kSize);
  mesh.material = kMarble;
  add_figure(&mesh, kFigure, {0, 1.7f, 0}, 1, .2f);
  mesh.material = kStone;
  add_lathe(&mesh, {0, 0, 0}, {kPedestal, kPedestalPoints}, kPedestalColumns);
  for (float x = -5; x <= 5; x += 10) {
    add_lathe(&mesh, {x, 0, -.2f}, {kColumnBase, kBasePoints}, kBaseColumns);
    add_shaft(&mesh, {x, .7f, -.2f}, kWallTop);
  }
  mesh.material = kPlaster;
  add_niche(&mesh);
  mesh.material = kFloor;
  add_quad(&mesh, {-kWallHalf, 0, 16}, {kWallHalf, 0, 16}, {kWallHalf, 0, -5}, {-kWallHalf, 0, -5});
  finish_mesh(mesh, scene);

  Array<Material> materials = default_array<Material>(arena, kMaterialCount);
  materials[kMarble] = glossy({.78f, .75f, .70f}, {.035f, .035f, .033f}, 14);
  materials[kStone] = glossy({.42f, .39f, .36f}, {.05f, .05f, .05f}, 40);
  materials[kPlaster] = matte({.34f, .17f, .12f});
  materials[kFloor] = glossy({.25f, .23f, .21f}, {.05f, .05f, .05f}, 60);
  scene->materials = materials;

  Array<Light> lights = default_array<Light>(arena, 3);
  lights[0] = spot_light({-8.6f, 12.5f, 7.2f}, {0, 5.6f, 0}, {430, 389, 327}, 16, 34);
  lights[1].position = {8, 4.5f, 9};
  lights[1].intensity = {17, 21, 29};
  lights[2] = spot_light({3.6f, 11.5f, -.4f}, {0, 6.5f, 0}, {90, 95, 110}, 25, 50);
  scene->lights = lights;
  scene->info.ambient = {.035f, .037f, .045f};
  set_camera(arena, scene, {.9f, 5.7f, 13.6f}, {0, 5.3f, 0}, 39);
}

}  // namespace pocketray
