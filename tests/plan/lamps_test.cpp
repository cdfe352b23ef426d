// How emissive materials divide into lamps.
#include "plan/lamps.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/generated_scene.h"

using namespace pocketray;

namespace {

std::uint32_t add_emitter(GeneratedScene* s) {
  Material m;
  m.emission = {1, 1, 1};
  return add_material(s, m);
}

// The number of triangles of each lamp. Each triangle that emits must be of exactly one.
std::vector<std::uint32_t> lamp_sizes(GeneratedScene* s) {
  s->bind();
  std::vector<std::uint32_t> sizes;
  std::vector<int> taken(s->triangles.size());
  each_lamp(s->scene, s->scene.materials, [&](const Lamp& lamp) {
    sizes.push_back(0);
    for (std::uint32_t t = 0; t < s->triangles.size(); ++t)
      if (is_part_of(s->scene, lamp, t)) ++sizes.back(), ++taken[t];
  });
  for (std::uint32_t t = 0; t < s->triangles.size(); ++t)
    CHECK(taken[t] == (is_zero(s->materials[s->triangles[t].material()].emission) ? 0 : 1));
  return sizes;
}

// A prism with walls of one quad each and lids that are fans.
void add_prism(GeneratedScene* s, std::uint32_t sides, std::uint32_t material) {
  auto at = [&](std::uint32_t i, float z) {
    const float angle = 2 * kPiF * static_cast<float>(i) / static_cast<float>(sides);
    return Vec3{std::cos(angle), std::sin(angle), z};
  };
  for (std::uint32_t i = 0; i < sides; ++i) add_quad(s, at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1), material);
  for (std::uint32_t i = 1; i + 1 < sides; ++i)
    for (bool top : {false, true}) {
      const float z = top ? 1.0f : 0.0f;
      const std::uint32_t a = add_vertex(s, at(0, z)), b = add_vertex(s, at(top ? i : i + 1, z)),
                          c = add_vertex(s, at(top ? i + 1 : i, z));
      add_triangle(s, a, b, c, material);
    }
}

void turn_inside_out(GeneratedScene* s) {
  for (Triangle& t : s->triangles) {
    const std::uint32_t b = t.vertex(1);
    t.set_vertex(1, t.vertex(2)), t.set_vertex(2, b);
  }
}

}  // namespace

// Goal: a lamp for each plane of a material that has few. Method: a sheet of many triangles, a box, and its inside.
TEST_CASE("lamps_are_the_planes_of_a_material") {
  GeneratedScene sheet;
  const std::uint32_t m = add_emitter(&sheet);
  for (int x = 0; x < 9; ++x)
    add_quad(&sheet, {float(x), 0, 0}, {float(x) + 1, 0, 0}, {float(x) + 1, 1, 0}, {float(x), 1, 0}, m);
  CHECK(lamp_sizes(&sheet) == std::vector<std::uint32_t>{18});
  GeneratedScene box;
  add_box(&box, {-1, -2, -3}, {1, 2, 3}, add_emitter(&box));
  CHECK(lamp_sizes(&box) == std::vector<std::uint32_t>(6, 2));
  turn_inside_out(&box);
  CHECK(lamp_sizes(&box) == std::vector<std::uint32_t>(6, 2));
}

// Goal: bulbs stay one lamp; a room of as many planes, whose walls light each other, does not. Method: prisms from outside
// and inside, up to more planes than are divided.
TEST_CASE("lamps_of_convex_bodies_stay_whole") {
  for (std::uint32_t sides : {4u, 5u, 14u, 15u})
    for (bool inside : {false, true}) {
      CAPTURE(sides);
      CAPTURE(inside);
      GeneratedScene s;
      add_prism(&s, sides, add_emitter(&s));
      if (inside) turn_inside_out(&s);
      const bool is_divided = inside ? sides + 2 <= kPiecesMax : sides + 2 <= kConvexPiecesMax;
      CHECK(lamp_sizes(&s).size() == (is_divided ? sides + 2 : 1));
    }
}

// Goal: never more lamps by dividing than leave room for all points. Method: boxes of a material each.
TEST_CASE("lamps_stay_few") {
  for (std::uint32_t boxes : {1u, 2u, 3u, 17u}) {
    GeneratedScene s;
    for (std::uint32_t i = 0; i < boxes; ++i) {
      const float x = 3 * static_cast<float>(i);
      add_box(&s, {x, 0, 0}, {x + 1, 1, 1}, add_emitter(&s));
    }
    CHECK(lamp_sizes(&s).size() == (6 * boxes <= kDividedLampsMax ? 6 * boxes : boxes));
  }
}
