// Instant radiosity: its virtual lights, what they give, and that a picture does not depend on how it is divided.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "base/fmath.h"
#include "effect/setting_list.h"
#include "indirect/instant_radiosity.h"
#include "instant_light.h"
#include "scene/builtin_helpers.h"
#include "support/divided_picture.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr float kAlbedo = 0.5f;

// A closed box of one albedo with a point light of intensity π in its middle; `things` adds a sphere and a wall.
struct Room : GeneratedScene {
  explicit Room(bool things) {
    Material grey;
    grey.diffuse = {kAlbedo, kAlbedo, kAlbedo};
    std::uint32_t material = add_material(this, grey);
    add_box(this, {-1, -1, -1}, {1, 1, 1}, material, true);
    if (things) {
      add_sphere(this, {0.3f, -0.6f, -0.2f}, 0.35f, 16, 8, material);
      Material mirror;
      mirror.diffuse = {0, 0, 0}, mirror.mirror = {0.8f, 0.8f, 0.8f};
      add_sphere(this, {-0.5f, -0.6f, -0.5f}, 0.3f, 16, 8, add_material(this, mirror));
      add_box(this, {-0.2f, -1, 0.2f}, {0, 0.2f, 0.4f}, material);
    }
    Light light = {};
    light.kind = LightKind::point;
    light.intensity = {kPiF, kPiF, kPiF};
    lights.push_back(light);
    aim(this, {0.1f, 0.05f, 0.9f}, {0, -0.2f, 0}, 70);
    bind();
  }
};

const VirtualLights& lights_of(const TestRenderer& t) { return *virtual_lights_of(t.renderer.frame.indirect); }

double power_of(const VirtualLights& lights) {
  double sum = 0;
  for (std::uint32_t i = 0; i < lights.count; ++i) sum += kPi * static_cast<double>(lights.light[i].intensity.y);
  return sum;
}

}  // namespace

// Goal: the stated bias of the bounded geometry term. Method: virtual lights on rings of a plane at height h; with the
// term clamped at b, E / (πL) = 2s − s², s = h√b.
TEST_CASE("hard_41_clamped_virtual_lights_of_a_plane") {
  constexpr double kHeight = 0.3, kStep = 1e-3;
  double sum = 0;
  Vec3 to_light;
  for (double r = kStep / 2; r < 300; r += kStep * (r < 3 ? 1 : r / 3)) {
    double ring = 2 * kPi * r * kStep * (r < 3 ? 1 : r / 3);
    VirtualLight light = {{static_cast<float>(r), static_cast<float>(kHeight), 0}, {0, -1, 0}, {1, 1, 1}};
    sum += ring * static_cast<double>(virtual_irradiance(light, 2, {0, 0, 0}, {0, 1, 0}, &to_light).y);
  }
  CHECK(sum / kPi == doctest::Approx(0.668528).epsilon(2e-3));
}

// Goal: degenerate and back-facing lights give nothing, and nothing infinite. Method: HARDCASES row 42, single lights.
TEST_CASE("hard_42_virtual_lights_at_and_behind_a_point") {
  Vec3 to_light;
  auto from = [&](const Vec3& position, const Vec3& normal) {
    return virtual_irradiance({position, normal, {1, 1, 1}}, 5, {0, 0, 0}, {0, 1, 0}, &to_light).y;
  };
  CHECK(from({0, 0, 0}, {0, -1, 0}) == 0);
  CHECK(from({0, 1, 0}, {0, 1, 0}) == 0);
  CHECK(from({0, -1, 0}, {0, 1, 0}) == 0);
  CHECK(from({0, 1, 0}, {0, -1, 0}) == 1);
  CHECK(from({0, 1e-20f, 0}, {0, -1, 0}) == 5);
}

// Goal: virtual lights have the power that surfaces reflect. Method: in a closed room of albedo ρ, Φ(ρ + ρ² + …), for
// several numbers of lights; every one lies within the room.
TEST_CASE("hard_42_virtual_lights_have_the_reflected_power") {
  Room room(false);
  for (std::uint32_t count : {32u, 64u, 128u, 256u, 512u}) {
    CAPTURE(count);
    std::unique_ptr<TestRenderer> t = rendered(room.scene, instant_settings(count));
    const VirtualLights& lights = lights_of(*t);
    CHECK(lights.count <= count * 9 / 8);
    CHECK(lights.count >= count * 7 / 8);
    CHECK(power_of(lights) ==
          doctest::Approx(4 * kPi * kPi * kAlbedo / (1 - kAlbedo)).epsilon(count < 128 ? 0.2 : 0.1));
    for (std::uint32_t i = 0; i < lights.count; ++i) CHECK(max_component(abs(lights.light[i].position)) < 1);
  }
}

// Goal: a room is as bright as it should be. Method: the mean light that arrives at a closed room's walls, direct and
// reflected, is Φ / (A (1 − ρ)) whatever the room's shape; lights bounded in corners take some of it away.
TEST_CASE("instant_radiosity_fills_a_room") {
  Room room(false);
  auto mean = [&](const Settings& settings) {
    std::unique_ptr<TestRenderer> t = rendered(room.scene, settings);
    double sum = 0;
    for (const Vec3& p : t->renderer.image) sum += static_cast<double>(p.y);
    return sum / t->renderer.image.count;
  };
  Settings without = instant_settings(512);
  without.indirect = IndirectChoice::none;
  double direct = mean(without), all = mean(instant_settings(512));
  CAPTURE(direct);
  // Reflected light is nearly even: (ρ / π) Φ / A × ρ / (1 − ρ).
  double expected = kAlbedo / kPi * (4 * kPi * kPi / 24) * kAlbedo / (1 - kAlbedo);
  CHECK(all - direct == doctest::Approx(expected).epsilon(0.12));
}

// Goal: a pixel is the same bits however the frame is divided. Method: a scene with edges, a curved surface and a
// mirror; the whole frame against rows, single pixels, spans at odd places and rays one by one; with two samples,
// compensated, and with an orthographic camera.
TEST_CASE("instant_radiosity_does_not_depend_on_spans") {
  Room room(true);
  for (std::uint32_t variant = 0; variant < 4; ++variant) {
    CAPTURE(variant);
    Settings settings = instant_settings(64);
    if (variant == 1) settings.samples_per_pixel = 2;
    if (variant == 2) settings.compensation = Compensation::rays;
    if (variant == 3) {
      room.cameras[0].projection = Projection::orthographic, room.cameras[0].vertical_extent = 1.5f;
      room.bind();
    }
    std::unique_ptr<TestRenderer> t = rendered(room.scene, settings);
    Renderer& renderer = t->renderer;
    const std::vector<Vec3> whole(renderer.image.begin(), renderer.image.end());
    const Divisions by(settings.height);
    auto differ = [&](const std::vector<Span>& spans, std::size_t group) {
      return different_pixels(renderer, whole, spans, group);
    };
    CHECK(differ(by.rows, 1) == 0);
    CHECK(differ(by.rows, 3) == 0);
    CHECK(differ(by.rows, 28) == 0);
    CHECK(differ(by.odd, 5) == 0);
    CHECK(differ(by.pixels, 7) == 0);
    renderer.frame.geometry.ray_by_ray = true;
    CHECK(differ(by.rows, 28) == 0);
    renderer.frame.geometry.ray_by_ray = false;
    for (const AccelInfo* info : kAccelList) {
      CAPTURE(info->name);
      std::unique_ptr<TestRenderer> other = make_renderer(room.scene, settings, info);
      REQUIRE(render_frame(&other->renderer, 0).ok);
      std::size_t different = 0;
      for (std::size_t i = 0; i < whole.size(); ++i) different += !same_pixel(other->renderer.image[i], whole[i]);
      CHECK(different == 0);
    }
  }
}

// Goal: no epsilon depends on the scene's size (HARDCASES row 29). Method: the same scene scaled by powers of two.
TEST_CASE("instant_radiosity_of_scaled_scenes_is_the_same") {
  Room room(true);
  Settings settings = instant_settings(64);
  settings.compensation = Compensation::rays;
  std::unique_ptr<TestRenderer> t = rendered(room.scene, settings);
  std::vector<Vec3> image(t->renderer.image.begin(), t->renderer.image.end());
  for (float scale : {0x1p-20f, 0x1p20f}) {
    CAPTURE(scale);
    Room scaled(true);
    for (Vec3& p : scaled.positions) p = p * scale;
    scaled.cameras[0].eye = scaled.cameras[0].eye * scale, scaled.cameras[0].target = scaled.cameras[0].target * scale;
    scaled.lights[0].intensity = scaled.lights[0].intensity * (scale * scale);
    scaled.bind();
    std::unique_ptr<TestRenderer> s = rendered(scaled.scene, settings);
    std::size_t different = 0;
    for (std::size_t i = 0; i < image.size(); ++i) different += !same_pixel(s->renderer.image[i], image[i]);
    CHECK(different == 0);
  }
}

namespace {

// The room with small boxes that no walk meets: in the sphere, all in one place. They turn about two axes, and rise.
// `sun`: under a directional light, in place of the point light.
struct RoomWithTurningBoxes : Room {
  RoomWithTurningBoxes(bool sun, double turn, float rise) : Room(true) {
    if (sun) lights[0].kind = LightKind::directional, lights[0].direction = {0.2f, -1, 0.1f};
    const std::size_t first = positions.size();
    for (int i = 0; i < 100; ++i) add_box(this, {-0.1f, -0.05f, -0.07f}, {0.1f, 0.05f, 0.07f}, 0);
    const float c = static_cast<float>(det_cos(turn)), s = static_cast<float>(det_sin(turn));
    for (std::size_t i = first; i < positions.size(); ++i) {
      Vec3 p = positions[i];
      p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
      positions[i] = Vec3{p.x, c * p.y - s * p.z, s * p.y + c * p.z} + Vec3{0.3f, -0.6f + rise, -0.2f};
    }
    bind();
  }
};

bool same_light(const VirtualLight& a, const VirtualLight& b) {
  return same_pixel(a.position, b.position) && same_pixel(a.normal, b.normal) && same_pixel(a.intensity, b.intensity) &&
         a.place == b.place;
}

std::uint32_t lights_kept(const VirtualLights& a, const VirtualLights& b) {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < a.count; ++i)
    kept += std::any_of(b.light, b.light + b.count,
                        [&](const VirtualLight& light) { return same_light(a.light[i], light); });
  return kept;
}

}  // namespace

// Goal: a virtual light stays, bit for bit, unless a moving object crosses its path [Jevans92, sec. 6.4], and so do
// their order and their bound, or all of the picture would flicker. Method: a box turns where no walk passes; then it
// comes out.
TEST_CASE("instant_radiosity_keeps_lights_whose_paths_nothing_crosses") {
  for (bool sun : {false, true}) {
    CAPTURE(sun);
    std::unique_ptr<TestRenderer> first = rendered(RoomWithTurningBoxes(sun, 0, 0).scene, instant_settings(64));
    const VirtualLights& before = lights_of(*first);
    REQUIRE(before.count > 40);
    for (double turn = 0.1; turn < 3; turn += 0.1) {
      CAPTURE(turn);
      std::unique_ptr<TestRenderer> turned = rendered(RoomWithTurningBoxes(sun, turn, 0).scene, instant_settings(64));
      const VirtualLights& now = lights_of(*turned);
      REQUIRE(now.count == before.count);
      CHECK(std::equal(now.light, now.light + now.count, before.light, same_light));
    }
    std::unique_ptr<TestRenderer> outside = rendered(RoomWithTurningBoxes(sun, 0, 1.0f).scene, instant_settings(64));
    std::uint32_t kept = lights_kept(before, lights_of(*outside));
    CHECK(kept > before.count / 4);
    if (!sun) CHECK(kept < before.count);
  }
}

// Goal: as objects move, lights are replaced one by one: no light depends on how long the paths of others are. Method:
// the animation of seesaw; between frames, a walk or two changes, of which each leaves nine lights at most.
TEST_CASE("instant_radiosity_replaces_lights_one_by_one") {
  auto built = build_builtin("seesaw");
  std::unique_ptr<TestRenderer> t = make_renderer(built->scene, instant_settings(64, 8, 6));
  VirtualLights last;
  std::uint32_t changes = 0;
  for (int frame = 0; frame <= 350; ++frame) {
    CAPTURE(frame);
    REQUIRE(render_frame(&t->renderer, frame / 25.0).ok);
    const VirtualLights& now = lights_of(*t);
    if (frame > 0) {
      const std::uint32_t lost = last.count - lights_kept(last, now);
      CHECK(lost <= 9);
      CHECK(now.geometry_max == last.geometry_max);
      changes += lost > 0;
    }
    last = now;
  }
  CHECK(changes > 50);
}

// Goal: how many walks there are does not depend on settings or the time at which a renderer begins, or the rows of a
// server would differ. Method: renderers that begin otherwise, then render the same frame, of a scene with a lamp.
TEST_CASE("instant_radiosity_sends_as_many_walks_whatever_came_before") {
  auto built = build_builtin("cornell");
  const Settings settings = instant_settings(512, 8, 6);
  std::unique_ptr<TestRenderer> t = make_renderer(built->scene, settings);
  REQUIRE(render_frame(&t->renderer, 4).ok);
  Settings first = settings;
  first.virtual_lights = 64, first.points_per_area_light = 9, first.normals = NormalMode::flat;
  std::unique_ptr<TestRenderer> other = make_renderer(built->scene, first);
  REQUIRE(render_frame(&other->renderer, 9).ok);
  REQUIRE(change_settings(&other->renderer, settings).ok);
  REQUIRE(render_frame(&other->renderer, 4).ok);
  const VirtualLights &a = lights_of(*t), &b = lights_of(*other);
  REQUIRE(a.count == b.count);
  CHECK(std::equal(a.light, a.light + a.count, b.light, same_light));
}

// Goal: light that shines past the scene at first is not lost when it turns to it. Method: a spot light.
TEST_CASE("instant_radiosity_finds_light_that_missed_the_scene_at_first") {
  Room room(false);
  Light* light = &room.lights[0];
  light->kind = LightKind::spot, light->cos_inner = 0.9f, light->cos_outer = 0.5f;
  light->position = {50, 0, 0}, light->direction = {1, 0, 0};
  std::unique_ptr<TestRenderer> t = rendered(room.scene, instant_settings(64));
  REQUIRE(lights_of(*t).count == 0);
  light->position = {0, 0, 0};
  t->renderer.lights.lit_mask = ~t->renderer.effects.mask;
  REQUIRE(render_frame(&t->renderer, 0).ok);
  std::unique_ptr<TestRenderer> fresh = rendered(room.scene, instant_settings(128));
  REQUIRE(lights_of(*t).count >= 64);
  CHECK(lights_of(*t).geometry_max > 0.5f * lights_of(*fresh).geometry_max);
}

// Goal: the same where the moving object is what ends the scene. Method: boxes rise by a hundredth over the room.
TEST_CASE("instant_radiosity_keeps_lights_as_the_bounds_change") {
  std::unique_ptr<TestRenderer> first = rendered(RoomWithTurningBoxes(true, 0, 1.7f).scene, instant_settings(64)),
                                second = rendered(RoomWithTurningBoxes(true, 0, 1.71f).scene, instant_settings(64));
  REQUIRE(first->renderer.frame.geometry.accel.bounds.high.y != second->renderer.frame.geometry.accel.bounds.high.y);
  const VirtualLights &a = lights_of(*first), &b = lights_of(*second);
  CHECK(lights_kept(a, b) > a.count / 2);
}

// Goal: coherence by tables of all rays, which do not tell whose light a pixel takes, stays off, and says why.
TEST_CASE("instant_radiosity_is_not_followed_by_tables") {
  Room room(true);
  Settings settings = instant_settings(64);
  settings.coherence = CoherenceMode::on;
  CHECK(rendered(room.scene, settings)->renderer.history.state.planned);
  settings.coherence_by_tables = true;
  std::unique_ptr<TestRenderer> t = rendered(room.scene, settings);
  CHECK_FALSE(t->renderer.history.state.planned);
  REQUIRE(t->renderer.history.state.unplanned_because != nullptr);
  CHECK(std::string(t->renderer.history.state.unplanned_because).find("pixels share light") != std::string::npos);
}

// Goal: virtual lights that memory was not planned for are refused.
TEST_CASE("instant_radiosity_is_planned_or_refused") {
  Room room(false);
  Settings settings = instant_settings(64);
  settings.indirect = IndirectChoice::none;
  std::unique_ptr<TestRenderer> t = rendered(room.scene, settings);
  Status status = change_settings(&t->renderer, [&] {
    Settings changed = t->renderer.settings;
    changed.indirect = indirect_choice(Effect::instant_radiosity);
    return changed;
  }());
  CHECK_FALSE(status.ok);
  CHECK(std::string(status.message).find("instant-radiosity") != std::string::npos);
}

// Goal: virtual lights cast shadows. Method: a box across the room, between the light and the viewer's half; with the
// shadow effect off, light passes through it.
TEST_CASE("instant_radiosity_is_shadowed") {
  Room room(false);
  add_box(&room, {-0.98f, -0.98f, -0.4f}, {0.98f, 0.98f, -0.3f}, 0);
  room.cameras[0].eye = {0, 0, -0.5f}, room.cameras[0].target = {0, 0, -1};
  room.bind();
  auto brightest = [&](EffectMask off) {
    Settings settings = instant_settings(128);
    settings.forced_off = off;
    std::unique_ptr<TestRenderer> t = rendered(room.scene, settings);
    float most = 0;
    for (const Vec3& p : t->renderer.image) most = max_component(p) > most ? max_component(p) : most;
    return most;
  };
  CHECK(brightest(0) < 0.2f * brightest(bit(Effect::shadow)));
}

// Goal: lights too faint for a ray of their own arrive as the others do: all of their light where nothing is in the
// way. Method: an empty room, with shadows and without, has the same bits.
TEST_CASE("instant_radiosity_of_an_empty_room_needs_no_shadows") {
  Room room(false);
  Settings settings = instant_settings(128), without = settings;
  without.forced_off = bit(Effect::shadow);
  std::unique_ptr<TestRenderer> a = rendered(room.scene, settings), b = rendered(room.scene, without);
  std::size_t different = 0;
  for (std::size_t i = 0; i < a->renderer.image.count; ++i)
    different += !same_pixel(a->renderer.image[i], b->renderer.image[i]);
  CHECK(different == 0);
}

// Goal: a pixel traces one ray and the inverse of sixteen tolerances to virtual lights, however many there are: their
// number is a budget of rays. Method: a room with things in it, none of which mirrors all lights at once; the rays, and
// the mean difference to a ray for every light; with a small tolerance the same bits.
TEST_CASE("instant_radiosity_of_many_lights_shares_rays") {
  Room room(true);
  room.materials[1] = room.materials[0];
  room.bind();
  auto rays_of = [](const TestRenderer& t) {
    std::uint64_t sum = 0;
    for (const Tracer& tracer : t.renderer.tracers) sum += tracer.rays[static_cast<int>(RayKind::shadow)];
    return static_cast<double>(sum);
  };
  Settings direct = instant_settings(64);
  direct.indirect = IndirectChoice::none;
  const double direct_rays = rays_of(*rendered(room.scene, direct));
  for (std::uint32_t count : {64u, 512u})
    for (float tolerance : {0x1p-12f, 0x1p-6f, 0x1p-4f}) {
      Settings settings = instant_settings(count);
      settings.light_tolerance = tolerance;
      std::unique_ptr<TestRenderer> shared = rendered(room.scene, settings);
      settings.light_tolerance = 0;
      std::unique_ptr<TestRenderer> every = rendered(room.scene, settings);
      const double pixels = every->renderer.image.count;
      std::size_t different = 0;
      double apart = 0, light = 0;
      for (std::size_t i = 0; i < every->renderer.image.count; ++i) {
        const Vec3 &a = shared->renderer.image[i], &b = every->renderer.image[i];
        different += !same_pixel(a, b);
        apart += static_cast<double>(max_component(abs(a - b))), light += static_cast<double>(max_component(b));
      }
      CAPTURE(count);
      CAPTURE(tolerance);
      CAPTURE(apart / light);
      if (tolerance < 0x1p-9f) {
        CHECK(different == 0);
        CHECK(rays_of(*shared) == rays_of(*every));
      } else {
        CHECK(different > 0);
        CHECK(apart < 0.06 * light);
        CHECK(rays_of(*shared) - direct_rays <= pixels * (1 + 1 / (16 * static_cast<double>(tolerance))));
        CHECK(rays_of(*shared) < rays_of(*every));
      }
    }
}

// Goal: a virtual light names the triangle that it lies on, which does not block its shadow rays, and is listed once,
// at its place in the pattern, which has its share of the lights.
TEST_CASE("virtual_lights_name_their_triangle_and_place") {
  const Room room(true);
  std::unique_ptr<TestRenderer> t = rendered(room.scene, instant_settings(128));
  const VirtualLights& lights = lights_of(*t);
  REQUIRE(lights.count > 64);
  REQUIRE((lights.first_of_place[0] == 0 && lights.first_of_place[kVirtualLightPlaces] == lights.count));
  for (std::uint32_t place = 0; place < kVirtualLightPlaces; ++place) {
    const std::uint32_t begin = lights.first_of_place[place], end = lights.first_of_place[place + 1];
    CHECK((end - begin) * kVirtualLightPlaces > lights.count / 3);
    for (std::uint32_t k = begin; k < end; ++k) {
      REQUIRE(lights.of_place[k] < lights.count);
      CHECK(lights.light[lights.of_place[k]].place == place);
      if (k > begin) CHECK(lights.of_place[k - 1] < lights.of_place[k]);
    }
  }
  for (std::uint32_t i = 0; i < lights.count; ++i) {
    REQUIRE(lights.light[i].triangle < room.triangles.size());
    const Triangle& triangle = room.triangles[lights.light[i].triangle];
    const Vec3 p = lights.light[i].position, &a = room.positions[triangle.vertex(0)],
               &b = room.positions[triangle.vertex(1)], &c = room.positions[triangle.vertex(2)];
    const Vec3 whole = cross(b - a, c - a);
    const float area = length(whole),
                parts = length(cross(a - p, b - p)) + length(cross(b - p, c - p)) + length(cross(c - p, a - p));
    CHECK(parts == doctest::Approx(area).epsilon(1e-4));
    CHECK(std::fabs(dot(lights.light[i].normal, whole)) == doctest::Approx(area).epsilon(1e-4));
  }
}
