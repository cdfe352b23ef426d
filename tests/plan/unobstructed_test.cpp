// Shadows in scenes where no surface can come between another and a light.
#include "plan/effects/unobstructed.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <string>

#include "brdf/brdf_list.h"
#include "plan/plan_effects.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

EffectDecision shadow_of(const GeneratedScene& s) {
  return plan_effects(s.scene, Settings()).decisions[static_cast<int>(Effect::shadow)];
}

// A prism of three to eight walls, a floor and a ceiling.
void add_prism(GeneratedScene* s, Rng* rng, std::uint32_t material) {
  const std::uint32_t sides = 3 + next_u32(rng) % 6, first = static_cast<std::uint32_t>(s->positions.size());
  for (int upper = 0; upper < 2; ++upper)
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2 * kPi * i / sides;
      add_vertex(
          s, {static_cast<float>(2 * det_cos(angle)), upper ? 1.7f : -0.4f, static_cast<float>(2 * det_sin(angle))});
    }
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = first + i, b = first + (i + 1) % sides;
    add_triangle(s, a, b, b + sides, material), add_triangle(s, a, b + sides, a + sides, material);
    if (i == 0 || b == first) continue;
    add_triangle(s, first, b, a, material), add_triangle(s, first + sides, a + sides, b + sides, material);
  }
}

// A room between two squares, whose ceiling surrounds a lamp.
void add_lamp_room(GeneratedScene* s, Rng* rng, std::uint32_t wall, std::uint32_t lamp) {
  const float upper = 0.5f + next_float(rng), half = upper * (0.1f + 0.8f * next_float(rng));
  const float x = (upper - half) * 0.9f * (2 * next_float(rng) - 1), z = (upper - half) * 0.9f * next_float(rng);
  auto add_square = [&](float center_x, float y, float center_z, float reach) {
    for (int i = 0; i < 4; ++i)
      add_vertex(s, {center_x + (i == 1 || i == 2 ? reach : -reach), y, center_z + (i >= 2 ? reach : -reach)});
  };
  add_square(0, -0.4f, 0, 1.2f), add_square(0, 1.7f, 0, upper), add_square(x, 1.7f, z, half);
  add_triangle(s, 0, 2, 1, wall), add_triangle(s, 0, 3, 2, wall);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    for (const std::uint32_t from : {0u, 4u})
      add_triangle(s, from + i, from + j, from + 4 + j, wall),
          add_triangle(s, from + i, from + 4 + j, from + 4 + i, wall);
  }
  add_triangle(s, 8, 9, 10, lamp), add_triangle(s, 8, 10, 11, lamp);
}

Vec3 point_within(Rng* rng, float reach) {
  auto coordinate = [&] { return reach * (2 * next_float(rng) - 1); };
  const float x = coordinate(), y = coordinate(), z = coordinate();
  return {x, 0.65f + 0.8f * y, z};
}

// An empty room, seen from inside, turned and scaled at random, or a floor under the sun.
std::unique_ptr<GeneratedScene> make_room(Rng* rng) {
  auto s = std::make_unique<GeneratedScene>();
  Material m;
  m.diffuse = {0.7f, 0.6f, 0.5f};
  if (next_u32(rng) % 2 == 0) {
    m.specular = {0.3f, 0.3f, 0.3f};
    m.brdf = next_u32(rng) % kBrdfCount, m.exponent = 20, m.roughness = 0.3f;
  }
  if (next_u32(rng) % 4 == 0) m.mirror = {0.2f, 0.2f, 0.2f};
  add_material(s.get(), m);
  const std::uint32_t kind = next_u32(rng) % 6;
  m.emission = {3, 3, 3}, m.double_sided = next_u32(rng) % 2;
  if (kind == 0)
    add_prism(s.get(), rng, 0);
  else if (kind >= 4)
    add_lamp_room(s.get(), rng, 0, add_material(s.get(), m));
  else if (kind == 1)
    add_quad(s.get(), {-2, -0.4f, 2}, {2, -0.4f, 2}, {2, -0.4f, -2}, {-2, -0.4f, -2}, 0);
  else
    add_box(s.get(), {-1.5f, -0.4f, -1.8f}, {1.4f, 1.7f, 1.9f}, 0, true);
  s->lights.resize(next_u32(rng) % 3 + (kind < 4));
  for (Light& light : s->lights) {
    light.position = point_within(rng, 0.5f), light.intensity = {2, 2, 2};
    if (next_u32(rng) % 3 == 0) light.kind = LightKind::spot, light.cos_outer = 0.2f;
    if (kind == 1 && next_u32(rng) % 2) light.kind = LightKind::directional, light.direction = {0, -0.6f, 0.8f};
  }
  const bool looks_at_edge = next_u32(rng) % 3 == 0, is_outside = next_u32(rng) % 8 == 0;
  Vec3 eye = point_within(rng, is_outside ? 9 : 0.5f), target = point_within(rng, 0.95f);
  const Triangle& t = s->triangles[next_u32(rng) % s->triangles.size()];
  if (looks_at_edge) target = (s->positions[t.vertex(0)] + s->positions[t.vertex(1)]) * 0.5f;
  if (next_u32(rng) % 2) {
    Quaternion turn = {next_float(rng) - 0.5f, next_float(rng) - 0.5f, next_float(rng) - 0.5f, next_float(rng)};
    const float norm = std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w);
    turn = {turn.x / norm, turn.y / norm, turn.z / norm, turn.w / norm};
    const float size = next_float(rng) + 0.2f;
    const Transform place = compose(point_within(rng, 0.7f), turn, {size, size, size});
    for (Vec3& p : s->positions) p = transform_point(place, p);
    for (Light& light : s->lights) {
      light.position = transform_point(place, light.position);
      light.direction = normalize(transform_vector(place, light.direction));
    }
    eye = transform_point(place, eye), target = transform_point(place, target);
  }
  aim(s.get(), eye, target, looks_at_edge ? 0.5 : 90);
  s->bind();
  return s;
}

void add_lamp(GeneratedScene* s, const Vec3& low, const Vec3& high) {
  Material lamp;
  lamp.emission = {5, 5, 5};
  add_quad(s, low, {high.x, low.y, low.z}, high, {low.x, high.y, high.z}, add_material(s, lamp));
}

}  // namespace

// Goal: where nothing can stand between a surface and a light, leaving out shadows changes no bit. Method: random empty
// rooms and floors under one to three lights or a lamp, seen from inside, from close to their edges and from outside,
// with and without the limit below which light is left out; most of them have no shadows by plan.
TEST_CASE("hard_73_empty_rooms_cast_no_shadows") {
  Rng rng = make_rng(47);
  int off = 0, wrong = 0, first_wrong = -1;
  const int rounds = effort(600);
  for (int round = 0; round < rounds; ++round) {
    const std::unique_ptr<GeneratedScene> s = make_room(&rng);
    const EffectDecision d = shadow_of(*s);
    if (d.on) continue;
    ++off;
    CHECK(std::string(d.reason) == "nothing stands between a surface and a light");
    Settings settings;
    settings.width = 64, settings.height = 48;
    if (round % 2) settings.cut_off_levels = 0;
    settings.points_per_area_light = round % 3 == 0 ? 16 : 4;
    const Picture automatic = render_picture(s->scene, settings);
    settings.forced_on = kAllEffects;
    if (!same_picture(automatic, render_picture(s->scene, settings)) && !wrong++) first_wrong = round;
  }
  CAPTURE(first_wrong);
  CHECK(wrong == 0);
  CHECK(2 * off > rounds);
}

// Goal: whatever might cast a shadow calls for the effect. Method: an empty room, and one change at a time.
TEST_CASE("hard_73_anything_in_a_room_may_cast_shadows") {
  const struct {
    const char* name;
    std::function<void(GeneratedScene* s)> change;
  } rows[] = {
      {"nothing", [](GeneratedScene*) {}},
      {"a speck",
       [](GeneratedScene* s) {
         add_quad(s, {0, 1, 0}, {0.01f, 1, 0}, {0.01f, 1, 0.01f}, {0, 1, 0.01f}, 0);
       }},
      {"a dent",
       [](GeneratedScene* s) {
         s->positions[0] += Vec3{0.1f, 0.1f, 0.1f};
       }},
      {"a light outside", [](GeneratedScene* s) { s->lights[0].position.y = 3; }},
      {"a light on a wall", [](GeneratedScene* s) { s->lights[0].position.y = 2 - 0x1p-14f; }},
      {"a sun", [](GeneratedScene* s) { s->lights[0].kind = LightKind::directional; }},
      {"lamps that meet",
       [](GeneratedScene* s) {
         s->materials[0].emission = {1, 1, 1};
       }},
      {"a hanging lamp",
       [](GeneratedScene* s) {
         add_lamp(s, {-0.3f, 1.5f, -0.3f}, {0.3f, 1.5f, 0.3f});
       }},
      {"a lamp at a wall",
       [](GeneratedScene* s) {
         add_lamp(s, {-1, 2, -0.3f}, {0.3f, 2, 0.3f});
       }},
      {"a lamp almost at a wall",
       [](GeneratedScene* s) {
         add_lamp(s, {-0.9999f, 2, -0.3f}, {0.3f, 2, 0.3f});
       }},
      {"nothing but a lamp",
       [](GeneratedScene* s) {
         add_lamp(s, {-0.3f, 2, -0.3f}, {0.3f, 2, 0.3f});
       }},
      {"normals",
       [](GeneratedScene* s) {
         s->with_normals = true, s->normals[0] = {0.6f, 0.8f, 0};
       }},
      {"a light on a node", [](GeneratedScene* s) { s->nodes.emplace_back(), s->lights[0].node = 0; }},
      {"a needle",
       [](GeneratedScene* s) {
         add_quad(s, {-1, 2, -1}, {1, 2, -1}, {1, 2, -0.98f}, {-1, 2, -0.98f}, 0);
       }},
  };
  for (const auto& row : rows) {
    CAPTURE(row.name);
    GeneratedScene s;
    add_material(&s, Material());
    add_box(&s, {-1, 0, -1}, {1, 2, 1}, 0, true);
    s.lights.resize(1);
    s.lights[0].position = {0.2f, 1.5f, 0.1f};
    aim(&s, {0, 1, 0.9f}, {0, 1, 0}, 60);
    row.change(&s);
    s.bind();
    CHECK(shadow_of(s).on == (std::string(row.name).find("nothing") != 0));
  }
}
