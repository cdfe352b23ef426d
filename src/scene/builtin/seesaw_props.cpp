#include "scene/builtin/seesaw_props.h"

#include "base/fmath.h"
#include "scene/builtin/seesaw_motion.h"

namespace pocketray {
namespace {

constexpr float kTentRadius = 12, kWallHeight = 4.8f;
constexpr Vec2 kRoof[kRoofBands + 1] = {{12, 4.8f}, {7.5f, 6.5f}, {3.4f, 8.6f}, {.25f, 11.2f}};
constexpr Vec2 kCurb[kCurbPoints] = {{6.1f, 0}, {6.05f, .42f}, {5.95f, .5f}, {5.65f, .5f}, {5.6f, 0}};
constexpr Vec2 kTub[kTubPoints] = {{.86f, 0},    {.86f, .1f},  {.8f, .1f}, {.6f, .66f},
                                   {.66f, .66f}, {.66f, .76f}, {0, .76f}};
constexpr Vec2 kPole[2] = {{.16f, 0}, {.13f, 9}};
constexpr Vec2 kWeight[kWeightPoints] = {{0, 0},       {.5f, 0},     {.56f, .06f}, {.56f, .2f},
                                         {.44f, .74f}, {.34f, .84f}, {.14f, .88f}, {0, .88f}};
constexpr Vec2 kCone[3] = {{0, 0}, {.2f, 0}, {0, .48f}};

Vec3 around(double turns, float radius, float y) {
  double azimuth = 2 * kPi * turns;
  return {radius * static_cast<float>(det_sin(azimuth)), y, radius * static_cast<float>(det_cos(azimuth))};
}

// A strip of canvas, seen from inside the tent.
void add_stripe(MeshWriter* mesh, std::uint32_t stripe) {
  double from = static_cast<double>(stripe) / kTentStripes,
         to = static_cast<double>((stripe + 1) % kTentStripes) / kTentStripes;
  mesh->material = stripe % 2 ? kTentRed : kTentCream;
  add_quad(mesh, around(to, kTentRadius, 0), around(from, kTentRadius, 0), around(from, kTentRadius, kWallHeight),
           around(to, kTentRadius, kWallHeight));
  for (std::uint32_t band = 0; band < kRoofBands; ++band) {
    Vec2 low = kRoof[band], high = kRoof[band + 1];
    add_quad(mesh, around(to, low.x, low.y), around(from, low.x, low.y), around(from, high.x, high.y),
             around(to, high.x, high.y));
  }
  // A pennant under the eaves, in the other colour.
  mesh->material = stripe % 4 == 0 ? kGold : stripe % 2 ? kTentCream : kBoardBlue;
  std::uint32_t first = add_vertex(mesh, around(to, kTentRadius - .2f, kWallHeight), {0, 0, 0});
  add_vertex(mesh, around(from, kTentRadius - .2f, kWallHeight), {0, 0, 0});
  add_vertex(mesh, around((stripe + .5) / kTentStripes, kTentRadius - .35f, kWallHeight - 1.0f), {0, 0, 0});
  add_triangle(mesh, first, first + 1, first + 2);
}

void add_ring_handle(MeshWriter* mesh, const Vec3& center, float radius, float thickness) {
  std::uint32_t first = mesh->vertex_count;
  for (std::uint32_t i = 0; i < kHandleColumns; ++i) {
    double turn = 2 * kPi * i / kHandleColumns;
    Vec3 out = {static_cast<float>(det_cos(turn)), static_cast<float>(det_sin(turn)), 0};
    for (std::uint32_t j = 0; j < kHandleRows; ++j) {
      double roll = 2 * kPi * j / kHandleRows;
      Vec3 normal = out * static_cast<float>(det_cos(roll)) + Vec3{0, 0, static_cast<float>(det_sin(roll))};
      add_vertex(mesh, center + out * radius + normal * thickness, normal);
    }
  }
  for (std::uint32_t i = 0; i < kHandleColumns; ++i) {
    for (std::uint32_t j = 0; j < kHandleRows; ++j) {
      std::uint32_t next_i = (i + 1) % kHandleColumns, next_j = (j + 1) % kHandleRows;
      std::uint32_t a = first + i * kHandleRows + j, b = first + next_i * kHandleRows + j;
      std::uint32_t c = first + next_i * kHandleRows + next_j, d = first + i * kHandleRows + next_j;
      add_triangle(mesh, a, b, c);
      add_triangle(mesh, a, c, d);
    }
  }
}

// Radius of the worm at height y: rounded tail, rings, a neck and a round head.
float worm_radius(float y) {
  float body_end = kWormLength - 0.62f;
  float radius = kWormRadius;
  if (y < .3f) radius *= std::sqrt(1 - (1 - y / .3f) * (1 - y / .3f));
  float rings = 1 - .13f * (1 - std::fabs(static_cast<float>(det_sin(kPi * 4.5 * static_cast<double>(y)))));
  radius *= y < body_end ? rings : 1 - .13f;
  float h = (y - (kWormLength - .36f)) / .36f;
  float head = h > -1 && h < 1 ? .40f * std::sqrt(1 - h * h) : 0;
  return head > radius || y > kWormLength - .36f ? head : radius;
}

}  // namespace

void add_tent(MeshWriter* mesh) {
  for (std::uint32_t stripe = 0; stripe < kTentStripes; ++stripe) add_stripe(mesh, stripe);
  mesh->material = kSawdust;
  std::uint32_t middle = add_vertex(mesh, {0, 0, 0}, {0, 1, 0});
  for (std::uint32_t i = 0; i < kFloorColumns; ++i)
    add_vertex(mesh, around(static_cast<double>(i) / kFloorColumns, kTentRadius + .1f, 0), {0, 1, 0});
  for (std::uint32_t i = 0; i < kFloorColumns; ++i)
    add_triangle(mesh, middle, middle + 1 + i, middle + 1 + (i + 1) % kFloorColumns);
  std::uint32_t curb = mesh->triangle_count;
  mesh->material = kCurbRed;
  add_lathe(mesh, {0, 0, 0}, {kCurb, kCurbPoints}, kCurbColumns);
  for (std::uint32_t i = curb + 2 * kCurbColumns; i < curb + 6 * kCurbColumns; ++i)
    mesh->triangles[i].set_material(kGold);
  mesh->material = kPoleWood;
  add_lathe(mesh, {-6.4f, 0, -5}, {kPole, 2}, kPoleColumns);
  add_lathe(mesh, {6.4f, 0, -5}, {kPole, 2}, kPoleColumns);
  std::uint32_t tub = mesh->triangle_count;
  mesh->material = kGold;
  add_lathe(mesh, {0, 0, 0}, {kTub, kTubPoints}, kTubColumns);
  for (std::uint32_t i = tub + 4 * kTubColumns; i < tub + 6 * kTubColumns; ++i)
    mesh->triangles[i].set_material((i - tub) / 4 % 2 ? kTentRed : kTentCream);
}

void add_board(MeshWriter* mesh) {
  constexpr float kEnd = 0.85f, kWidth = .55f;
  const Vec3 thick = {0, kBoardHalfThickness, 0};
  mesh->material = kBoardBlue;
  add_box(mesh, Vec3{-kBoardHalfLength + kEnd, 0, -kWidth} - thick, Vec3{kBoardHalfLength - kEnd, 0, kWidth} + thick);
  mesh->material = kTentRed;
  add_box(mesh, Vec3{-kBoardHalfLength, 0, -kWidth} - thick, Vec3{-kBoardHalfLength + kEnd, 0, kWidth} + thick);
  add_box(mesh, Vec3{kBoardHalfLength - kEnd, 0, -kWidth} - thick, Vec3{kBoardHalfLength, 0, kWidth} + thick);
}

void add_weight(MeshWriter* mesh) {
  mesh->material = kIron;
  add_lathe(mesh, {0, 0, 0}, {kWeight, kWeightPoints}, kWeightColumns);
  add_ring_handle(mesh, {0, 1.03f, 0}, .19f, .055f);
}

void add_worm(MeshWriter* mesh) {
  std::uint32_t first_vertex = mesh->vertex_count, first_triangle = mesh->triangle_count;
  mesh->material = kWormSkin;
  add_vertex(mesh, {0, 0, 0}, {0, 0, 0});
  for (std::uint32_t row = 1; row <= kWormRows; ++row) {
    float y = kWormLength * (1 - static_cast<float>(det_cos(kPi * row / (kWormRows + 1)))) / 2;
    y = .6f * y + .4f * kWormLength * static_cast<float>(row) / (kWormRows + 1);  // denser at both ends
    for (std::uint32_t column = 0; column < kWormColumns; ++column)
      add_vertex(mesh, around(static_cast<double>(column) / kWormColumns, worm_radius(y), y), {0, 0, 0});
  }
  add_vertex(mesh, {0, kWormLength, 0}, {0, 0, 0});
  add_tube_triangles(mesh, first_vertex, kWormColumns, kWormRows);
  smooth_normals(mesh, first_vertex, first_triangle);
  for (std::uint32_t i = first_triangle; i < mesh->triangle_count; ++i) {  // the belly is in front, below the head
    Triangle* t = &mesh->triangles[i];
    Vec3 p = mesh->positions[t->vertex(0)];
    if (p.z > .72f * worm_radius(p.y) && p.y < kWormLength - .7f) t->set_material(kWormBelly);
  }

  const Vec3 face = {0, kWormLength - .36f, 0};
  for (float side = -1; side <= 1; side += 2) {
    mesh->material = kEyeWhite;
    add_sphere(mesh, face + Vec3{side * .155f, .13f, .30f}, {.125f, .155f, .1f}, 14, 9);
    mesh->material = kPupil;
    add_sphere(mesh, face + Vec3{side * .135f, .12f, .385f}, {.055f, .08f, .03f}, 10, 5);
  }
  mesh->material = kMouth;
  add_sphere(mesh, face + Vec3{0, -.175f, .345f}, {.13f, .04f, .05f}, 12, 5);
  for (float side = -1; side <= 1; side += 2)
    add_sphere(mesh, face + Vec3{side * .14f, -.135f, .335f}, {.05f, .045f, .05f}, 8, 4);
  mesh->material = kHat;
  add_lathe(mesh, face + Vec3{0, .31f, 0}, {kCone, 3}, kHatColumns);
  mesh->material = kGold;
  add_sphere(mesh, face + Vec3{0, .80f, 0}, {.07f, .07f, .07f}, 10, 6);
}

}  // namespace pocketray
