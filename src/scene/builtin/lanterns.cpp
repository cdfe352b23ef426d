// A street on the night of a lantern festival: 200 lanterns, each a point light below a paper shade, and twelve lit
// windows, which are area lights. Tests scenes with many lights.
#include "base/check.h"
#include "base/rng.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/figure.h"
#include "scene/builtin/mesh_writer.h"
#include "scene/builtin/scene_parts.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kStringCount = 14, kPerString = 10;  // across the street
constexpr std::uint32_t kEavesCount = 30;                    // along each side
constexpr std::uint32_t kLanternCount = kStringCount * kPerString + 2 * kEavesCount;
constexpr std::uint32_t kHouseCount = 10, kWindowCount = 6;  // on each side
static_assert(kLanternCount == 200 && 2 * kWindowCount == 12, "as described in builtin.cpp");

constexpr float kStreetHalf = 4, kStreetEnd = -60;  // it starts behind the camera, at z = 8
constexpr float kHouseDepth = 7, kHouseWidth = 6.4f;
constexpr std::uint32_t kLanternColumns = 10, kLanternRows = 6;

constexpr MeshSize kLanternSize = sphere_size(kLanternColumns, kLanternRows);
constexpr MeshSize kHouseSize = box_size() + MeshSize{6, 8} + box_size();
constexpr MeshSize kGateSize = 5 * box_size();
constexpr FigureDetail kFigure = {40, 60, 12, 12, 9};
constexpr MeshSize kSize = kLanternCount * kLanternSize + kStringCount * (kPerString + 1) * quad_size() +
                           2 * kHouseCount * kHouseSize + 2 * kWindowCount * quad_size() + 5 * quad_size() + kGateSize +
                           box_size() + figure_size(kFigure);

enum MaterialIndex : std::uint32_t {
  kStone,
  kWater,
  kPlaster,
  kTimber,
  kRoof,
  kLacquer,
  kMarble,
  kString,
  kPaperRed,
  kPaperOrange,
  kPaperGold,
  kWindow,
  kMaterialCount = kWindow + 2 * kWindowCount
};

// One of the festival's three shades, by number.
struct Shade {
  Vec3 paper, light;
};
constexpr Shade kShades[3] = {
    {{.82f, .09f, .035f}, {1, .3f, .12f}}, {{.92f, .3f, .07f}, {1, .5f, .17f}}, {{.98f, .57f, .22f}, {1, .68f, .32f}}};

struct Festival {
  MeshWriter mesh;
  Array<Light> lights;
  std::uint32_t light_count = 0;
};

// A lantern and its light just below it, whose shade hides everything above.
void add_lantern(Festival* f, const Vec3& at, float radius, std::uint32_t shade, float brightness) {
  CHECK_LT(shade, 3u);
  CHECK_LT(f->light_count, f->lights.count);
  f->mesh.material = kPaperRed + shade;
  add_sphere(&f->mesh, at, {radius, radius * 1.25f, radius}, kLanternColumns, kLanternRows);
  Light& light = f->lights[f->light_count++];
  light.position = at - Vec3{0, radius * 1.5f, 0};
  light.intensity = kShades[shade].light * (.65f * brightness);
}

// Lanterns on a string that sags between the houses.
void add_string(Festival* f, float z, float height, Rng* rng) {
  const float step = 2 * kStreetHalf / (kPerString + 1);
  auto at = [&](std::uint32_t i) {
    float x = -kStreetHalf + step * static_cast<float>(i), sag = 1 - x * x / (kStreetHalf * kStreetHalf);
    return Vec3{x, height - .9f * sag, z};
  };
  for (std::uint32_t i = 0; i <= kPerString; ++i) {
    const Vec3 a = at(i), b = at(i + 1), thick = {0, .025f, 0};
    f->mesh.material = kString;
    add_quad(&f->mesh, a, b, b + thick, a + thick);
    if (i == 0) continue;
    const auto shade = static_cast<std::uint32_t>(next_float(rng) * 3);
    const float brightness = .8f + .5f * next_float(rng);
    add_lantern(f, a - Vec3{0, .3f, 0}, .15f + .05f * next_float(rng), shade, brightness);
  }
}

// A house with a roof that reaches over the street; side is -1 or 1.
void add_house(MeshWriter* mesh, float side, float front_z, float height) {
  CHECK(side == -1 || side == 1);
  CHECK_GT(height, 2.95f);  // above the beam
  const float inner = side * kStreetHalf, outer = side * (kStreetHalf + kHouseDepth), back_z = front_z - kHouseWidth;
  const float left = inner < outer ? inner : outer, right = inner < outer ? outer : inner;
  mesh->material = kPlaster;
  add_box(mesh, {left, 0, back_z}, {right, height, front_z});
  mesh->material = kTimber;  // a beam above the ground floor
  const float beam = inner - side * .12f, wall = inner + side * .05f;
  add_box(mesh, {beam < wall ? beam : wall, 2.7f, back_z}, {beam < wall ? wall : beam, 2.95f, front_z});
  mesh->material = kRoof;
  const float eaves = inner - side * .55f, ridge = side * (kStreetHalf + kHouseDepth / 2);
  const float low = height - .1f, high = height + 2.1f;
  const std::uint32_t first = mesh->vertex_count;
  for (float z : {front_z + .15f, back_z - .15f}) {
    add_vertex(mesh, {eaves, low, z}, {0, 0, 0});
    add_vertex(mesh, {ridge, high, z}, {0, 0, 0});
    add_vertex(mesh, {outer, low, z}, {0, 0, 0});
  }
  constexpr std::uint8_t kFaces[8][3] = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1},
                                         {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  for (const auto& face : kFaces) {
    const bool turned = side < 0;
    add_triangle(mesh, first + face[0], first + face[turned ? 1 : 2], first + face[turned ? 2 : 1]);
  }
}

void add_houses(Festival* f, Rng* rng) {
  for (std::uint32_t i = 0; i < kHouseCount; ++i)
    for (float side : {-1.0f, 1.0f})
      add_house(&f->mesh, side, 4 - static_cast<float>(i) * (kHouseWidth + .1f), 4.6f + 1.8f * next_float(rng));
  for (std::uint32_t i = 0; i < kWindowCount; ++i)
    for (std::uint32_t side = 0; side < 2; ++side) {
      f->mesh.material = kWindow + 2 * i + side;
      const float sign = side ? 1.0f : -1.0f, x = sign * (kStreetHalf - .02f);
      const float z = -.2f - static_cast<float>(2 * i + side) * (kHouseWidth + .1f) * .75f, half = .8f;
      const Vec3 low = {x, .9f, z + sign * half}, high = {x, 2.3f, z + sign * half}, along = {0, 0, -2 * sign * half};
      add_quad(&f->mesh, low, high, high + along, low + along);
    }
}

// A gate across the street: two posts, two beams and a tablet between these.
void add_gate(MeshWriter* mesh, float z) {
  mesh->material = kLacquer;
  for (float x : {-2.5f, 2.5f}) add_box(mesh, {x - .2f, 0, z - .2f}, {x + .2f, 4.3f, z + .2f});
  add_box(mesh, {-3, 3.5f, z - .14f}, {3, 3.75f, z + .14f});
  add_box(mesh, {-3.6f, 4.3f, z - .25f}, {3.6f, 4.65f, z + .25f});
  add_box(mesh, {-.35f, 3.75f, z - .1f}, {.35f, 4.3f, z + .1f});
}

// Pavements beside a stream with low banks.
void add_ground(MeshWriter* mesh) {
  constexpr float kStreamHalf = 1.1f, kLevel = -.1f, kNear = 8, kWide = kStreetHalf + kHouseDepth;
  mesh->material = kWater;
  add_quad(mesh, {-kStreamHalf, kLevel, kNear}, {kStreamHalf, kLevel, kNear}, {kStreamHalf, kLevel, kStreetEnd},
           {-kStreamHalf, kLevel, kStreetEnd});
  mesh->material = kStone;
  for (float x : {-kStreamHalf, kStreamHalf}) {
    const float near = x < 0 ? kNear : kStreetEnd, far = x < 0 ? kStreetEnd : kNear;
    add_quad(mesh, {x, kLevel, near}, {x, kLevel, far}, {x, 0, far}, {x, 0, near});
  }
  add_quad(mesh, {-kWide, 0, kNear}, {-kStreamHalf, 0, kNear}, {-kStreamHalf, 0, kStreetEnd}, {-kWide, 0, kStreetEnd});
  add_quad(mesh, {kStreamHalf, 0, kNear}, {kWide, 0, kNear}, {kWide, 0, kStreetEnd}, {kStreamHalf, 0, kStreetEnd});
}

}  // namespace

std::size_t lanterns_need() { return mesh_need(kSize) + parts_need(kMaterialCount, kLanternCount, 1); }

void build_lanterns(Arena* arena, Scene* scene) {
  name_scene(scene, "lanterns");
  Rng rng = make_rng(15);
  Festival f;
  f.mesh = make_mesh(arena, kSize);
  f.lights = default_array<Light>(arena, kLanternCount);
  for (std::uint32_t i = 0; i < kStringCount; ++i)
    add_string(&f, -1 - 4 * static_cast<float>(i), 4.5f + .5f * next_float(&rng), &rng);
  for (std::uint32_t i = 0; i < kEavesCount; ++i)
    for (float side : {-1.0f, 1.0f}) {
      const auto shade = static_cast<std::uint32_t>(next_float(&rng) * 3);
      add_lantern(&f, {side * 3.62f, 3.15f, 1 - 2 * static_cast<float>(i)}, .17f, shade, .45f);
    }
  add_houses(&f, &rng);
  add_gate(&f.mesh, -9);
  add_ground(&f.mesh);
  const Vec3 plinth = {2.45f, 0, -3.4f};
  f.mesh.material = kTimber;
  add_box(&f.mesh, plinth - Vec3{.4f, 0, .4f}, plinth + Vec3{.4f, .7f, .4f});
  f.mesh.material = kMarble;
  add_figure(&f.mesh, kFigure, plinth + Vec3{0, .7f, 0}, .24f, -.5f);
  finish_mesh(f.mesh, scene);
  CHECK_EQ(f.light_count, f.lights.count);
  scene->lights = f.lights;

  Array<Material> materials = default_array<Material>(arena, kMaterialCount);
  materials[kStone] = matte({.3f, .28f, .26f});
  materials[kWater] = matte({.02f, .03f, .035f});
  materials[kWater].mirror = {.45f, .47f, .5f};
  materials[kPlaster] = matte({.56f, .5f, .42f});
  materials[kTimber] = matte({.2f, .13f, .08f});
  materials[kRoof] = matte({.12f, .14f, .18f});
  materials[kLacquer] = matte({.62f, .07f, .04f});
  materials[kMarble] = matte({.7f, .68f, .64f});
  materials[kString] = matte({.08f, .07f, .06f});
  for (std::uint32_t i = 0; i < 3; ++i) {
    materials[kPaperRed + i] = matte(kShades[i].paper);
    materials[kPaperRed + i].unlit = 1;
  }
  for (std::uint32_t i = 0; i < 2 * kWindowCount; ++i)
    materials[kWindow + i] = emitter(Vec3{.72f, .43f, .19f} * (.7f + .6f * next_float(&rng)), {.5f, .45f, .4f});
  scene->materials = materials;
  scene->info.background = {.004f, .006f, .013f};
  scene->info.ambient = {.008f, .008f, .012f};
  scene->info.exposure = 2;
  set_camera(arena, scene, {-.45f, 1.9f, 6.4f}, {.1f, 2.3f, -8}, 56);
}

}  // namespace pocketray
