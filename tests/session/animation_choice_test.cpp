// Which animation --animation chooses, and cameras in the coordinates of models far from the origin.
#include "session/animation_choice.h"

#include <doctest/doctest.h>

#include <cstring>

#include "session/scene_options.h"

using namespace pocketray;

namespace {

struct Labelled {
  Animation animations[3] = {{0, 4, 3}, {0, 2, 2}, {2, 2, 3}};
  AnimationLabel labels[3] = {};
  Scene scene;
  explicit Labelled(const char* first, const char* second) {
    labels[0].combines = 1;
    std::strcpy(labels[0].drives, "0 'a', 1 'b'");
    std::strcpy(labels[1].name, first), std::strcpy(labels[1].drives, "node 0 (scale)");
    std::strcpy(labels[2].name, second);
    scene.animations = {animations, 3};
    scene.animation_labels = {labels, 3};
  }
};

std::uint32_t chosen(const Scene& scene, const char* asked) {
  std::uint32_t index = 77;
  CHECK(find_animation(scene, asked, &index).ok);
  return index;
}

}  // namespace

// Goal: a name, a number, all and none choose; anything else is refused with what there is. A name comes before a
// number. Method: scenes with labels, without, and without animations.
TEST_CASE("animation_choice_finds_names_and_numbers") {
  const Labelled two("walk", "1");
  CHECK(chosen(two.scene, "") == 0);
  CHECK(chosen(two.scene, "all") == 0);
  CHECK(chosen(two.scene, "none") == kNone);
  CHECK(chosen(two.scene, "0") == 1);
  CHECK(chosen(two.scene, "walk") == 1);
  CHECK(chosen(two.scene, "1") == 2);
  CHECK(numbered_animations(two.scene).size() == 2);
  CHECK(describe_animation(two.scene, 1) == "animation 0 'walk', 2 s: node 0 (scale)");
  CHECK(describe_animation(two.scene, 0) == "together, 3 s: 0 'a', 1 'b'");
  for (const char* wrong : {"2", "-1", "run", "1.0", " 1", "99999999999"}) {
    std::uint32_t index;
    const Status status = find_animation(two.scene, wrong, &index);
    CHECK(!status.ok);
    CHECK(std::strstr(status.message, "0 'walk', 1 '1'") != nullptr);
  }
  const Labelled named_all("all", "none");
  CHECK(chosen(named_all.scene, "none") == 2);
  Scene old = two.scene;
  old.animation_labels = {};
  CHECK(chosen(old, "2") == 2);
  CHECK(describe_animation(old, 1) == "animation 1, 2 s: 2 channels");
  Scene still;
  CHECK(chosen(still, "all") == 0);
  CHECK(chosen(still, "none") == kNone);
  std::uint32_t index;
  CHECK(!find_animation(still, "0", &index).ok);
}

// Goal: --camera counts in the model's own coordinates, whose digits a float does not hold. Method: an eye a thousandth
// beside the origin of UTM coordinates.
TEST_CASE("camera_of_a_model_far_away_keeps_its_digits") {
  Camera camera;
  REQUIRE(parse_camera("431250.371,120.5,5411875.623 431250.37,120.5,5411874.62 0,1,0 45", &camera,
                       {431250.37, 120.5, 5411875.62})
              .ok);
  CHECK(camera.eye.x == doctest::Approx(0.001).epsilon(1e-4));
  CHECK(camera.eye.y == 0);
  CHECK(camera.eye.z == doctest::Approx(0.003).epsilon(1e-4));
  CHECK(camera.target.z == -1);
  CHECK(camera.up == Vec3{0, 1, 0});
}
