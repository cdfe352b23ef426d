// Where the camera of a room without one stands, and where it looks.
#include "plan/interior.h"

#include <doctest/doctest.h>

#include <cmath>

#include "plan/plan_scene.h"
#include "plan/room.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

struct Standpoint {
  bool found = false;
  Vec3 eye = {0, 0, 0}, target = {0, 0, 0};
};
Standpoint standpoint(GeneratedScene* s) {
  s->bind();
  Standpoint at;
  at.found = find_place_to_stand(s->scene, scene_bounds(s->scene), &at.eye, &at.target);
  return at;
}
float free_view(const GeneratedScene& s, const Standpoint& at) {
  return free_distance(s.scene, at.eye, normalize(at.target - at.eye));
}

// A hall along x, or z, with two rows of columns, walls of thickness 0.5 and sides around it.
void add_hall(GeneratedScene* s, bool along_z, float scale) {
  const std::uint32_t white = add_material(s, {});
  auto box = [&](Vec3 low, Vec3 high, bool room) {
    if (along_z) std::swap(low.x, low.z), std::swap(high.x, high.z);
    add_box(s, low * scale, high * scale, white, room);
  };
  box({-20, 0, -8}, {20, 12, 8}, true);
  box({-20.5f, -0.5f, -8.5f}, {20.5f, 12.5f, 8.5f}, false);
  for (int i = -3; i <= 3; ++i)
    for (float side : {-4.0f, 4.0f}) {
      const float x = static_cast<float>(i) * 5;
      box({x - 0.5f, 0, side - 0.5f}, {x + 0.5f, 12, side + 0.5f}, false);
    }
}

}  // namespace

// Goal: in a hall one stands at eye height and looks along it, between the columns. Method: a hall of 40 × 16 × 12
// along either axis; in metres the eye is at 1.6, in a unit that makes it 1,200 high, at 0.55 of the height.
TEST_CASE("interior_looks_along_a_hall_at_eye_height") {
  for (bool along_z : {false, true})
    for (float scale : {1.0f, 100.0f}) {
      CAPTURE(along_z);
      CAPTURE(scale);
      GeneratedScene s;
      add_hall(&s, along_z, scale);
      const Standpoint at = standpoint(&s);
      REQUIRE(at.found);
      CHECK(at.eye.y == doctest::Approx(scale > 1 ? 660 : 1.6));
      CHECK(at.target.y == at.eye.y);
      const Vec3 way = normalize(at.target - at.eye);
      CHECK(std::fabs(along_z ? way.z : way.x) > 0.9f);
      CHECK(free_view(s, at) > 35 * scale);
      CHECK(free_view(s, at) == doctest::Approx(length(at.target - at.eye)).epsilon(1e-4));
    }
}

// Goal: one stands on the floor, not on a table, a gallery or the roof, and in none of the furniture. Method: a room
// with a table over an eighth of it and a gallery over a half; a block over a twelfth of the floor. The eye has a floor
// below at the height of the room's, and no surface nearer than arm's length.
TEST_CASE("interior_stands_on_the_floor") {
  GeneratedScene s;
  const std::uint32_t white = add_material(&s, {});
  add_box(&s, {-5, 0, -5}, {5, 6, 5}, white, true);
  add_box(&s, {-4, 0, -4}, {0, 0.8f, -1}, white);
  add_box(&s, {-5, 2.8f, 0}, {5, 3, 5}, white);
  add_box(&s, {-5, 0, 3}, {-1, 2.8f, 5}, white);
  const Standpoint at = standpoint(&s);
  REQUIRE(at.found);
  CHECK(free_distance(s.scene, at.eye, {0, -1, 0}) == doctest::Approx(at.eye.y));
  for (int i = 0; i < 64; ++i) {
    const float turn = static_cast<float>(i) * 0.0982f;
    CHECK(free_distance(s.scene, at.eye, {std::cos(turn), 0, std::sin(turn)}) > 0.4f);
  }
  CHECK(free_view(s, at) > 8);
}

// Goal: without a floor, or without walls around it, there is no place; the camera looks across the bounds as before.
// Method: a box without a bottom; a floor with one wall.
TEST_CASE("interior_without_a_place_to_stand") {
  GeneratedScene roof;
  add_quad(&roof, {-2, 3, -2}, {2, 3, -2}, {2, 3, 2}, {-2, 3, 2}, add_material(&roof, {}));
  add_quad(&roof, {-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}, 0);
  CHECK_FALSE(standpoint(&roof).found);
  GeneratedScene corner;
  add_quad(&corner, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, add_material(&corner, {}));
  add_quad(&corner, {-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}, 0);
  CHECK_FALSE(standpoint(&corner).found);
  GeneratedScene flat;
  add_quad(&flat, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, add_material(&flat, {}));
  CHECK_FALSE(standpoint(&flat).found);
  GeneratedScene room;
  add_box(&room, {-2, 0, -2}, {2, 3, 2}, add_material(&room, {}), true);
  room.bind();
  const Box bounds = scene_bounds(room.scene);
  DefaultView view;
  view.is_room = 1;
  CHECK(default_camera(view, Framing(), bounds, 1.5f).eye == inside_camera(bounds).eye);
  CHECK(default_camera(view, find_framing(room.scene, view, bounds), bounds, 1.5f).eye.y == doctest::Approx(1.6));
}
