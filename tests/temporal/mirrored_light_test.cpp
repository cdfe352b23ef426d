// Coherence of virtual lights on surfaces that only a mirror shows.
#include <doctest/doctest.h>

#include <cstring>

#include "effect/setting_list.h"
#include "engine/frame.h"
#include "temporal/moving_scene.h"

using namespace pocketray;

namespace {

// The camera sees a mirror alone, and in it a floor that a spot on a wall lights. The vertices from `mover` on are a
// box between the two, which the mirror does not show.
struct FloorInMirror : GeneratedScene {
  std::uint32_t mover;
  FloorInMirror() {
    Material white, mirror;
    white.diffuse = {0.8f, 0.8f, 0.8f}, white.double_sided = true;
    mirror.diffuse = {0, 0, 0}, mirror.mirror = {1, 1, 1}, mirror.double_sided = true;
    add_material(this, white), add_material(this, mirror);
    add_quad(this, {-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, 0);
    add_quad(this, {-3, 0, -3}, {3, 0, -3}, {3, 4, -3}, {-3, 4, -3}, 0);
    add_quad(this, {2, 0, 1.5f}, {-2, 0, 1.5f}, {-2, 3, 1.5f}, {2, 3, 1.5f}, 1);
    mover = vertex_count(*this);
    add_box(this, {-0.15f, 1.1f, -2.15f}, {0.15f, 1.4f, -1.85f}, 0);
    let_move(this, mover);
    Light light = {};
    light.kind = LightKind::spot, light.position = {0, 2, 1};
    light.direction = normalize(Vec3{0, 2.5f, -3} - light.position);
    light.intensity = {500, 500, 500}, light.cos_inner = 0.998f, light.cos_outer = 0.995f;
    lights.push_back(light);
    aim(this, {0, 1, 0}, {0, 0.64f, 1}, 20);
    bind();
  }
};

}  // namespace

// Goal: a shadow seen in a mirror follows what casts it. Method: a box moves between a lit wall and the floor, where no
// ray of a first hit, of the camera or of a mirror passes, and no walk; coherent frames against whole ones.
TEST_CASE("shadows_of_virtual_lights_in_mirrors_are_followed") {
  FloorInMirror scene;
  Settings settings;
  settings.width = 48, settings.height = 36;
  settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = 12;
  std::unique_ptr<TestRenderer> whole = make_renderer(scene.scene, settings);
  settings.coherence = CoherenceMode::on;
  std::unique_ptr<TestRenderer> coherent = make_renderer(scene.scene, settings);
  const CoherenceState& state = coherent->renderer.history.state;
  std::vector<Vec3> last;
  std::uint32_t moved = 0;
  for (int frame = 0; frame < 6; ++frame) {
    CAPTURE(frame);
    REQUIRE(render_frame(&whole->renderer, 0.5).ok);
    REQUIRE(render_frame(&coherent->renderer, changes_at(0.5)).ok);
    const Array<Vec3>&a = whole->renderer.image, &b = coherent->renderer.image;
    CHECK(std::memcmp(a.data, b.data, a.bytes()) == 0);
    if (frame > 0) {
      CHECK(state.whole_because == nullptr);
      CHECK(state.pixels_traced < 48 * 36);
      moved += std::memcmp(a.data, last.data(), a.bytes()) != 0;
    }
    last.assign(a.begin(), a.end());
    for (Vec3& p : scene.rest_positions) p.x += 0.1f;
  }
  CHECK(moved >= 3);
}
