// Cases that only just reach a bound: shadow rays that start far off their points, and triangles that rays hit beside
// their boxes. Each of them once gave a wrong frame.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "base/rng.h"
#include "engine/frame.h"
#include "support/effort.h"
#include "temporal/moving_scene.h"

using namespace pocketray;

namespace {

Material grey() {
  Material m;
  m.diffuse = {0.5f, 0.5f, 0.5f};
  return m;
}

// Moves the moving vertices by move(frame), and counts the frames that are not as if traced whole.
template <class Move>
int wrong_frames(GeneratedScene* s, std::uint32_t side, int frames, Move move) {
  s->bind();
  Settings settings;
  settings.width = settings.height = side;
  auto whole = make_renderer(s->scene, settings);
  settings.coherence = CoherenceMode::on;
  auto coherent = make_renderer(s->scene, settings);
  const std::vector<Vec3> rest = s->rest_positions;
  int wrong = 0, partial = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const Vec3 by = move(frame);
    for (std::size_t i = 0; i < rest.size(); ++i) s->rest_positions[i] = rest[i] + by;
    REQUIRE(render_frame(&whole->renderer, 0).ok);
    REQUIRE(render_frame(&coherent->renderer, changes_at(0)).ok);
    const Array<Vec3>&a = whole->renderer.image, &b = coherent->renderer.image;
    const bool same = std::memcmp(a.data, b.data, a.bytes()) == 0;
    if (!same) forget_last_frame(&coherent->renderer.history);
    wrong += !same, partial += !coherent->renderer.history.state.whole_because;
  }
  CHECK(partial >= frames / 2);
  return wrong;
}

// A floor of two triangles whose normals lean outward, as if it were the top of a dome.
void add_dome(GeneratedScene* s, float half_side, float lean, float normal_length) {
  s->with_normals = true;
  const std::uint32_t material = add_material(s, grey());
  auto corner = [&](float x, float z) {
    return add_vertex(s, {x * half_side, 0, z * half_side}, normalize(Vec3{x * lean, 1, z * lean}) * normal_length);
  };
  const std::uint32_t a = corner(-1, 1), b = corner(1, 1), c = corner(1, -1), d = corner(-1, -1);
  add_triangle(s, a, b, c, material);
  add_triangle(s, a, c, d, material);
}

}  // namespace

// Goal: shadow rays that start above a coarse curved surface end as far above the lamp. Method: something moves close
// to a lamp below the surface's plane.
TEST_CASE("narrow_shadow_rays_end_beside_the_lamp") {
  GeneratedScene s;
  add_dome(&s, 2, 0.2f, 1);
  const std::uint32_t first = vertex_count(s);
  add_box(&s, {3.8f, 0.1f, -0.3f}, {3.85f, 0.5f, 0.3f}, 0);
  let_move(&s, first);
  Light light;
  light.intensity = {9, 9, 9};
  light.position = {4, -0.02f, 0};
  s.lights.push_back(light);
  aim(&s, {0, 6, 0.5f}, {0.5f, 0, 0}, 30);
  CHECK(wrong_frames(&s, effort_side(120), effort(100), [](int frame) {
          return Vec3{0, 0.003f * static_cast<float>(frame - 30), 0};
        }) == 0);
}

// Goal: shadow rays start off their points by the error of their triangle, however small the part in view. Method: the
// shadow of a small box on floors of all sizes.
TEST_CASE("narrow_shadow_rays_start_as_far_off_as_their_triangles_are_large") {
  for (float half_side : {3.0f, 1e4f, 1e6f}) {
    for (LightKind kind : {LightKind::point, LightKind::directional}) {
      CAPTURE(half_side);
      GeneratedScene s;
      add_material(&s, grey());
      const float h = half_side;
      add_quad(&s, {-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h}, 0);
      const std::uint32_t first = vertex_count(s);
      add_box(&s, {0.5f, 0.5f, -0.25f}, {1, 1, 0.25f}, 0);
      let_move(&s, first);
      Light light;
      light.kind = kind;
      light.intensity = {9, 9, 9};
      light.position = {2.5f, 3, 0.2f};
      light.direction = normalize(Vec3{-1, -1, -0.1f});
      s.lights.push_back(light);
      aim(&s, {0, 3, 3}, {0, 0, 0}, 30);
      CHECK(wrong_frames(&s, effort_side(150), effort(160), [](int frame) {
              return Vec3{0.003f * static_cast<float>(frame), 0, 0.001f * static_cast<float>(frame)};
            }) == 0);
    }
  }
}

// Goal: normals may be 1 % too long, and so may be what they lift.
TEST_CASE("narrow_long_normals_lift_farther") {
  GeneratedScene s;
  add_dome(&s, 2, 0.081f * 0.7071f, 1.0099f);
  const std::uint32_t first = vertex_count(s);
  add_box(&s, {3, 0, -3}, {3.2f, 1, 3}, 0);
  let_move(&s, first);
  Light light;
  light.kind = LightKind::directional;
  light.intensity = {9, 9, 9};
  light.direction = normalize(Vec3{-1, 0.005f, 0});
  s.lights.push_back(light);
  aim(&s, {0, 6, 0.5f}, {0.5f, 0, 0}, 30);
  CHECK(wrong_frames(&s, effort_side(240), effort(200), [](int frame) {
          return Vec3{0, 0.0006f * static_cast<float>(frame), 0};
        }) == 0);
}

// Goal: a triangle is hit by rays that miss its box by the rounding along its longest axis. Method: a needle seen from
// close by, moved by fractions of its width.
TEST_CASE("narrow_needles_are_hit_beside_their_boxes") {
  for (float half_length : {10.0f, 1000.0f}) {
    CAPTURE(half_length);
    GeneratedScene s;
    Material red = grey();
    red.emission = {1, 0.5f, 0.2f};
    add_material(&s, red);
    const float h = 1e-3f, z = half_length;
    add_quad(&s, {0, h, -z}, {0, h, z}, {0, -h, z}, {0, -h, -z}, 0);
    let_move(&s, 0);
    Light light;
    light.position = {5, 5, 5};
    s.lights.push_back(light);
    s.scene.info.background = {0.1f, 0.2f, 0.3f};
    aim(&s, {0.01f, h - 0.0166667f, 0}, {0, h, 0.0333333f}, 1);
    Rng rng = make_rng(1);
    CHECK(wrong_frames(&s, 96, effort(300), [&](int) {
            return Vec3{1e-4f * next_float(&rng), 1e-5f * (next_float(&rng) - 0.5f), 0};
          }) == 0);
  }
}
