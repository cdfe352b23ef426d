// Which scenes are seen from inside, and from which side the others are.
#include "plan/room.h"

#include <doctest/doctest.h>

#include <cmath>

#include "plan/plan_scene.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

Room room_of(GeneratedScene* s) {
  s->bind();
  return find_room(s->scene, scene_bounds(s->scene));
}
Camera camera_of(const Scene& scene, float aspect) {
  const Box bounds = scene_bounds(scene);
  const DefaultView view = find_default_view(scene, bounds);
  return default_camera(view, find_framing(scene, view, bounds), bounds, aspect);
}
bool is_room(GeneratedScene* s) { return room_of(s).is_room; }

// Two shells: walls with a front inside and one outside.
void add_thick_room(GeneratedScene* s, float wall) {
  const std::uint32_t white = add_material(s, {});
  add_box(s, {-4, 0, -3}, {4, 3, 3}, white, true);
  add_box(s, {-4 - wall, -wall, -3 - wall}, {4 + wall, 3 + wall, 3 + wall}, white);
}

bool is_within(const Vec3& p, const Vec3& low, const Vec3& high) {
  return p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z > low.z && p.z < high.z;
}

// A sheet across z = 0 whose front is at the side of `towards`.
void add_backdrop(GeneratedScene* s, float towards) {
  const std::uint32_t white = add_material(s, {});
  if (towards > 0)
    add_quad(s, {-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, white);
  else
    add_quad(s, {2, -2, 0}, {-2, -2, 0}, {-2, 2, 0}, {2, 2, 0}, white);
}

}  // namespace

// Goal: a room is seen from inside, whether its walls have one side or two. Method: one shell and two, with a table;
// the eye stands between the walls, and nothing stands between it and the middle.
TEST_CASE("room_of_thin_or_thick_walls_is_seen_from_inside") {
  for (float wall : {0.0f, 0.1f, 1.0f}) {
    CAPTURE(wall);
    GeneratedScene s;
    if (wall > 0)
      add_thick_room(&s, wall);
    else
      add_box(&s, {-4, 0, -3}, {4, 3, 3}, add_material(&s, {}), true);
    add_box(&s, {-1, 0, -1}, {1, 0.8f, 1}, add_material(&s, {}));
    const Room room = room_of(&s);
    CHECK(room.is_room);
    CHECK(room.has_thick_walls == (wall > 0));
    CHECK(is_zero(room.opening));
    const Camera camera = camera_of(s.scene, 4.0f / 3);
    CHECK(is_within(camera.eye, {-4, 0, -3}, {4, 3, 3}));
    const Vec3 middle = center(scene_bounds(s.scene)), way = camera.eye - middle;
    CHECK(free_distance(s.scene, middle, normalize(way)) > length(way));
  }
}

// Goal: a closed body whose winding is reversed is no room, and is seen from outside; with a table or a lamp in it, or
// without a wall, it is a room. Method: a box and a ball turned inside out.
TEST_CASE("room_is_no_body_of_reversed_winding") {
  auto reversed = [](bool ball) {
    auto s = std::make_unique<GeneratedScene>();
    const std::uint32_t white = add_material(s.get(), {});
    if (!ball) {
      add_box(s.get(), {0, 0, 0}, {1, 1, 1}, white, true);
      return s;
    }
    auto at = [](int along, int up) {
      const float turn = static_cast<float>(along) * 0.2618f, height = static_cast<float>(up) * 0.2618f;
      return Vec3{std::sin(height) * std::cos(turn), std::cos(height), std::sin(height) * std::sin(turn)};
    };
    for (int i = 0; i < 24; ++i)
      for (int k = 0; k < 12; ++k) add_quad(s.get(), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k), at(i, k), white);
    return s;
  };
  for (bool ball : {false, true}) {
    CAPTURE(ball);
    auto s = reversed(ball);
    CHECK_FALSE(is_room(s.get()));
    const Box bounds = scene_bounds(s->scene);
    CHECK_FALSE(is_within(camera_of(s->scene, 4.0f / 3).eye, bounds.low, bounds.high));
    add_box(s.get(), {0.4f, 0.1f, 0.4f}, {0.6f, 0.2f, 0.6f}, 0);
    CHECK(is_room(s.get()));
    auto lit = reversed(ball);
    lit->lights.push_back({});
    CHECK(is_room(lit.get()));
  }
}

// Goal: a room without a wall is looked into from there. Method: each wall of a box in turn.
TEST_CASE("room_without_a_wall_is_seen_through_the_opening") {
  for (const Vec3& out : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}}) {
    GeneratedScene s;
    add_box(&s, {-2, -2, -2}, {2, 2, 2}, add_material(&s, {}), true);
    s.bind();
    std::size_t kept = 0;
    for (const Triangle& t : std::vector<Triangle>(s.triangles)) {
      Vec3 sum = {0, 0, 0};
      for (std::uint32_t v : t.vertices()) sum += s.positions[v];
      if (dot(sum, out) < 5.9f) s.triangles[kept++] = t;
    }
    REQUIRE(kept == 10);
    s.triangles.resize(kept);
    const Room room = room_of(&s);
    CHECK(room.is_room);
    CHECK(dot(room.opening, out) > 0.99f);
    CHECK(dot(camera_of(s.scene, 4.0f / 3).eye, out) > 2);
  }
}

// Goal: a thick-walled room without its front wall, or roof, is a room still. Method: five rays in 26 may leave.
TEST_CASE("room_of_thick_walls_may_be_open") {
  GeneratedScene s;
  const std::uint32_t white = add_material(&s, {});
  add_box(&s, {-5, -1, -5}, {5, 0, 5}, white);  // floor, and walls around it
  add_box(&s, {-5, 0, -5}, {-4, 5, 5}, white), add_box(&s, {4, 0, -5}, {5, 5, 5}, white);
  add_box(&s, {-4, 0, -5}, {4, 5, -4}, white), add_box(&s, {-4, 0, 4}, {4, 5, 5}, white);
  CHECK_FALSE(is_room(&s));  // nine rays leave through the missing roof
  add_box(&s, {-5, 5, -5}, {5, 6, 0}, white);
  CHECK(is_room(&s));
}

// Goal: objects are not rooms, however they are folded or scattered. Method: solids, a solid within a solid, sheets,
// and a heap of boxes around the middle.
TEST_CASE("room_is_no_object") {
  GeneratedScene solid;
  add_box(&solid, {-1, -1, -1}, {1, 1, 1}, add_material(&solid, {}));
  CHECK_FALSE(is_room(&solid));
  add_box(&solid, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, 0);
  CHECK_FALSE(is_room(&solid));

  GeneratedScene sheet;
  add_backdrop(&sheet, 1);
  CHECK_FALSE(is_room(&sheet));

  GeneratedScene heap;
  Rng rng = make_rng(3);
  const std::uint32_t white = add_material(&heap, {});
  for (int i = 0; i < 300; ++i) {
    const Vec3 at = {next_float(&rng) * 8 - 4, next_float(&rng) * 8 - 4, next_float(&rng) * 8 - 4};
    if (length(at) < 4) add_box(&heap, at, at + Vec3{1, 1, 1}, white);
  }
  CHECK_FALSE(is_room(&heap));

  GeneratedScene vessel;  // a ball with a hollow inside
  const std::uint32_t clay = add_material(&vessel, {});
  for (float radius : {1.0f, -0.9f})
    for (int i = 0; i < 24; ++i)
      for (int k = 0; k < 12; ++k) {
        auto at = [&](int along, int up) {
          const float turn = static_cast<float>(along) * 0.2618f, height = static_cast<float>(up) * 0.2618f;
          return Vec3{std::sin(height) * std::cos(turn), std::cos(height), -std::sin(height) * std::sin(turn)} * radius;
        };
        add_quad(&vessel, at(i, k + 1), at(i + 1, k + 1), at(i + 1, k), at(i, k), clay);
      }
  CHECK_FALSE(is_room(&vessel));

  GeneratedScene none;
  CHECK_FALSE(is_room(&none));
}

// Goal: a backdrop is seen from its front, and everything else as ever. Method: sheets that face each way; solids.
TEST_CASE("default_camera_looks_at_the_front_of_open_surfaces") {
  for (float towards : {1.0f, -1.0f}) {
    GeneratedScene s;
    add_backdrop(&s, towards);
    add_box(&s, {-0.5f, -2, towards - 0.5f}, {0.5f, 0, towards + 0.5f}, 0);
    s.bind();
    CHECK(camera_of(s.scene, 4.0f / 3).eye.z * towards > 1);
  }
  GeneratedScene solid;
  add_box(&solid, {-1, -1, -1}, {1, 1, 1}, add_material(&solid, {}));
  solid.bind();
  const Vec3 towards = normalize(Vec3{0.45f, 0.35f, 1.0f});
  auto seen_from = [](const GeneratedScene& scene) {
    return normalize(camera_of(scene.scene, 4.0f / 3).eye - center(scene_bounds(scene.scene)));
  };
  CHECK(dot(seen_from(solid), towards) > 0.999f);
  GeneratedScene floor;  // shows its front to all sides
  add_quad(&floor, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, add_material(&floor, {}));
  floor.bind();
  CHECK(dot(seen_from(floor), towards) > 0.999f);
}

// Goal: a scene that was baked is seen as before it was, without a look at its triangles. Method: rooms and solids; the
// same view stored with other triangles.
TEST_CASE("default_view_is_taken_as_stored") {
  for (float wall : {0.0f, 0.3f}) {
    GeneratedScene room;
    add_thick_room(&room, wall);
    room.bind();
    const Box bounds = scene_bounds(room.scene);
    DefaultView view = find_default_view(room.scene, bounds);
    CHECK(view.is_room == 1);
    CHECK((view.inside_share > 0 && view.inside_share <= 1));
    GeneratedScene solid;
    add_box(&solid, bounds.low, bounds.high, add_material(&solid, {}));
    solid.bind();
    CHECK(find_default_view(solid.scene, bounds).is_room == 0);
    solid.scene.default_view = {&view, 1};
    Framing framing = find_framing(room.scene, view, bounds);
    CHECK(framing.eye != framing.target);
    solid.scene.framings = {&framing, 1};
    CHECK(camera_of(solid.scene, 1.5f).eye == camera_of(room.scene, 1.5f).eye);
    framing = {};
    view.inside_share = 0.5f;
    const Vec3 middle = center(bounds);
    CHECK(camera_of(solid.scene, 1.5f).eye == middle + (inside_camera(bounds).eye - middle) * 0.5f);
    view.is_room = 0, view.side = 3, solid.scene.framings = {};
    CHECK(camera_of(solid.scene, 1.5f).eye.x < -4);
  }
}
