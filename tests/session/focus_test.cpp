// A camera on one part of a model.
#include "session/focus.h"

#include <doctest/doctest.h>

#include <cstring>

using namespace pocketray;

namespace {

SceneSource model() {
  SceneSource source;
  source.parts = {{"Wheel.Front", {{0, 0, 0}, {1, 1, 1}}},
                  {"Wheel.Back", {{5, 0, 0}, {6, 1, 1}}},
                  {"Body", {{0, 1, 0}, {6, 3, 1}}},
                  {"Wheel.Back", {{5, 0, 4}, {6, 1, 5}}}};
  return source;
}

}  // namespace

// Goal: a part is found by its name, with all of that name; a wrong name lists those near it first. Method: names, a
// slip, another case, part of a name; a scene without parts.
TEST_CASE("focus_finds_parts_by_name") {
  Box box;
  REQUIRE(find_part(model(), "car.glb", "Body", &box).ok);
  CHECK(box.high == Vec3{6, 3, 1});
  REQUIRE(find_part(model(), "car.glb", "Wheel.Back", &box).ok);
  CHECK(box.low == Vec3{5, 0, 0});
  CHECK(box.high == Vec3{6, 1, 5});
  auto told = [&](const char* name) { return std::string(find_part(model(), "car.glb", name, &box).message); };
  CHECK(told("Bodi") == "--focus: car.glb has no part 'Bodi'; similar ones: 'Body', 'Wheel.Back', 'Wheel.Front'");
  CHECK(told("back").find("similar ones: 'Wheel.Back'") != std::string::npos);
  CHECK(told("WHEEL.FROMT").find("similar ones: 'Wheel.Front'") != std::string::npos);
  CHECK(told(std::string(100'000, 'x').c_str()).find("similar ones: 'Body'") != std::string::npos);
  CHECK(std::strstr(find_part(SceneSource(), "a.pray", "Body", &box).message, "a .pray file keeps no names"));
  CHECK(std::strstr(find_part(SceneSource(), "cornell", "Body", &box).message, "cornell has none"));
}

// Goal: the camera looks at the part from the same side and shows all of it. Method: its corners project into the
// picture, some near the edge.
TEST_CASE("focus_frames_the_part") {
  Camera camera;
  camera.eye = {20, 30, 40}, camera.target = {0, 0, 0};
  const Box box = {{5, 0, 4}, {6, 1, 5}};
  const Camera focused = focused_camera(camera, box, 1.5f, 0.7);
  CHECK(length(focused.target - center(box)) < 0.2f);  // the middle of the picture
  const Vec3 before = normalize(camera.target - camera.eye), forward = normalize(focused.target - focused.eye);
  CHECK(length(before - forward) < 1e-5f);
  const Vec3 right = normalize(cross(forward, focused.up)), up = cross(right, forward);
  float most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 c = Vec3{corner & 1 ? 6.0f : 5.0f, corner & 2 ? 1.0f : 0.0f, corner & 4 ? 5.0f : 4.0f} - focused.eye;
    const float half = 0.36502f * dot(c, forward);  // tan(0.35)
    most = std::max({most, std::fabs(dot(c, up)) / half, std::fabs(dot(c, right)) / (1.5f * half)});
  }
  CHECK(most < 1);
  CHECK(most > 0.85f);
}
