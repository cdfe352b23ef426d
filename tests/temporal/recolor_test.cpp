// Materials that change between frames: what is traced again, and what it shows.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "effect/setting_list.h"
#include "engine/frame.h"
#include "engine/recolor.h"
#include "support/test_environment.h"
#include "temporal/moving_scene.h"

using namespace pocketray;

namespace {

struct Pair {
  std::unique_ptr<GeneratedScene> scene;
  std::unique_ptr<TestEnvironment> environment;  // or none
  std::unique_ptr<TestRenderer> whole, coherent;
};

Pair make_pair(std::unique_ptr<GeneratedScene> scene, Settings settings, bool with_environment = false) {
  Pair pair;
  pair.scene = std::move(scene);
  pair.scene->bind();
  if (with_environment) {
    pair.environment = std::make_unique<TestEnvironment>(16, 8, Vec3{1, 1, 1}, [](const Vec3d& d, int) {
      return d.y > 0.5 ? Vec3d{2, 2, 2} : Vec3d{0.5, 0.5, 0.5};
    });
    pair.environment->give(&pair.scene->scene);
    settings.environment_shadows = 32;
  }
  pair.whole = make_renderer(pair.scene->scene, settings, nullptr, nullptr, true);
  settings.coherence = CoherenceMode::on;
  pair.coherent = make_renderer(pair.scene->scene, settings, nullptr, nullptr, true);
  return pair;
}

Settings settings_of(std::uint32_t samples = 1) {
  Settings settings = settings_for(0, 60, 45);
  settings.samples_per_pixel = samples;
  return settings;
}

std::uint32_t pixel_count(const Pair& pair) { return pair.whole->renderer.image.count; }

bool same_frames(const Pair& pair) {
  REQUIRE(render_frame(&pair.whole->renderer, 0).ok);
  REQUIRE(render_frame(&pair.coherent->renderer, changes_at(0)).ok);
  const Array<Vec3>&a = pair.whole->renderer.image, &b = pair.coherent->renderer.image;
  return std::memcmp(a.data, b.data, a.bytes()) == 0;
}

// The first two frames: whole, and unchanged.
void start(const Pair& pair) {
  REQUIRE(same_frames(pair));
  REQUIRE(same_frames(pair));
  REQUIRE(pair.coherent->renderer.history.state.pixels_traced == 0);
}

std::string whole_because(const Pair& pair) {
  const char* why = pair.coherent->renderer.history.state.whole_because;
  return why ? why : "";
}

// Puts the material in place and compares the frame. Returns how many pixels were traced.
std::uint64_t recolored_to(const Pair& pair, std::uint32_t material, const Material& m) {
  for (TestRenderer* each : {pair.whole.get(), pair.coherent.get()}) {
    REQUIRE(check_recolored(&each->renderer, material, m).ok);
    REQUIRE(change_material(&each->renderer, material, m).ok);
  }
  CHECK(same_frames(pair));
  return pair.coherent->renderer.history.state.pixels_traced;
}

// Pixels of which a first hit shows the material.
std::uint64_t count_shown(const Pair& pair, std::uint32_t material) {
  const Renderer& r = pair.coherent->renderer;
  const std::uint32_t pixels = pixel_count(pair);
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < pixels; ++i) {
    bool shows = false;
    for (std::uint32_t sample = 0; sample < r.settings.samples_per_pixel; ++sample) {
      const Hit& hit = r.history.coherence.first_hits[sample * pixels + i];
      shows |= hit.triangle != kNoTriangle && r.scene.triangles[hit.triangle].material() == material;
    }
    count += shows;
  }
  return count;
}

Material matte(const Vec3& albedo) {
  Material m;
  m.diffuse = albedo;
  return m;
}

void add_light(GeneratedScene* s, LightKind kind = LightKind::point) {
  Light light;
  light.kind = kind;
  light.position = {0, 4, 1}, light.direction = normalize(Vec3{-0.1f, -1, -0.2f});
  light.intensity = kind == LightKind::directional ? Vec3{2, 2, 2} : Vec3{20, 20, 20};
  s->lights.push_back(light);
}

// A floor of material 0 and a box of material 1.
std::unique_ptr<GeneratedScene> box_on_floor(const Material& floor) {
  auto s = std::make_unique<GeneratedScene>();
  add_quad(s.get(), {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, add_material(s.get(), floor));
  add_box(s.get(), {-0.6f, 0, -0.6f}, {0.4f, 1, 0.4f}, add_material(s.get(), matte({0.6f, 0.3f, 0.2f})));
  aim(s.get(), {0.5f, 2.5f, 5}, {0, 0.4f, 0}, 45);
  return s;
}

// Texels with and without holes, in other places for each seed.
std::uint32_t add_holes(GeneratedScene* s, std::uint32_t seed) {
  std::vector<std::array<int, 4>> texels;
  for (std::uint32_t i = 0; i < 16; ++i) texels.push_back({250, 200, 90, (i * 5 + i / 4 + seed) % 3 == 0 ? 0 : 255});
  return add_texture(s, 4, 4, texels, Wrap::repeat, Wrap::repeat, true);
}

enum class Pane { holes, blended, glass, absorbing };

// A floor of material 0, and above it, out of sight, a pane of material 1 with another texture to put on it; material 2
// is like it.
std::unique_ptr<GeneratedScene> pane_over_floor(Pane kind) {
  auto s = std::make_unique<GeneratedScene>();
  s->with_uvs = true;
  Material pane = matte({0.5f, 0.4f, 0.3f});
  if (kind == Pane::holes) pane.alpha_mode = AlphaMode::mask;
  if (kind == Pane::blended) pane.alpha_mode = AlphaMode::blend;
  if (kind == Pane::glass || kind == Pane::absorbing) pane.transmission = {0.9f, 0.7f, 0.5f};
  if (kind == Pane::absorbing) pane.absorption = {1, 2, 3};
  pane.thin = kind == Pane::glass;
  pane.diffuse_texture.texture = add_holes(s.get(), 0);
  add_holes(s.get(), 1);
  add_quad(s.get(), {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, add_material(s.get(), matte({0.7f, 0.7f, 0.7f})));
  const std::uint32_t material = add_material(s.get(), pane);
  if (kind == Pane::absorbing)
    add_box(s.get(), {-0.5f, 3, -0.5f}, {0.5f, 3.2f, 0.5f}, material);
  else
    add_quad(s.get(), {-0.5f, 3, 0.5f}, {0.5f, 3, 0.5f}, {0.5f, 3, -0.5f}, {-0.5f, 3, -0.5f}, material);
  add_box(s.get(), {40, 0, 0}, {41, 1, 1}, add_material(s.get(), pane));
  aim(s.get(), {0, 2.5f, 5}, {0, 0, 0}, 40);
  return s;
}

Material pane_changed(Pane kind, Material m) {
  if (kind == Pane::holes || kind == Pane::blended) m.diffuse_texture.texture = 1;
  if (kind == Pane::glass) m.transmission = {0.2f, 0.7f, 0.9f};
  if (kind == Pane::absorbing) m.absorption = {3, 0.5f, 1};
  return m;
}

}  // namespace

// Goal: only what shows the material is traced again, and nothing if it is the same. Method: the pixels whose first
// hits show it, counted; one and two samples.
TEST_CASE("recoloring_retraces_the_pixels_that_show_it") {
  for (std::uint32_t samples : {1u, 2u}) {
    CAPTURE(samples);
    auto s = box_on_floor(matte({0.5f, 0.5f, 0.5f}));
    add_light(s.get());
    const Pair pair = make_pair(std::move(s), settings_of(samples));
    start(pair);
    const std::uint64_t shown = count_shown(pair, 1);
    CHECK(shown > 100);
    CHECK(shown < pixel_count(pair) / 3);
    Material m = pair.scene->materials[1];
    m.diffuse = {0.1f, 0.9f, 0.4f};
    CHECK(recolored_to(pair, 1, m) == shown);
    CHECK(recolored_to(pair, 1, m) == 0);
    m.diffuse = {0, 0, 0};
    CHECK(recolored_to(pair, 1, m) == shown);
    CHECK(recolored_to(pair, 1, pair.scene->materials[1]) == shown);
    CHECK(whole_because(pair) == "");
  }
}

// Goal: recolouring is seen in mirrors, and its pixels alone are traced. Method: a mirror floor; colours exchanged, so
// that bounds stay.
TEST_CASE("recoloring_is_seen_in_mirrors") {
  Material floor = matte({0.2f, 0.2f, 0.2f});
  floor.mirror = {0.5f, 0.5f, 0.5f};
  auto s = box_on_floor(floor);
  add_light(s.get());
  const Pair pair = make_pair(std::move(s), settings_of());
  start(pair);
  Material m = pair.scene->materials[1];
  m.diffuse = {0.2f, 0.6f, 0.3f};
  const std::uint64_t shown = count_shown(pair, 1), traced = recolored_to(pair, 1, m);
  CHECK(whole_because(pair) == "");
  CHECK(traced > shown + 50);
  CHECK(traced < pixel_count(pair) / 2);
}

// Goal: pixels about a surface follow when it begins or ceases to take the environment's light, and only then. Method:
// black and back; with a texture that may be black anywhere, every other colour counts.
TEST_CASE("recoloring_under_an_environment_reaches_neighbours") {
  for (bool is_textured : {false, true}) {
    CAPTURE(is_textured);
    auto s = box_on_floor(matte({0.5f, 0.5f, 0.5f}));
    s->with_uvs = true;
    const std::uint32_t texture = add_texture(s.get(), 2, 1, {{{0, 255, 0, 255}}, {{255, 0, 0, 255}}});
    if (is_textured) s->materials[1].diffuse_texture.texture = texture;
    s->materials[0].diffuse_texture.texture = add_texture(s.get(), 1, 1, {{{255, 255, 255, 255}}});
    const Pair pair = make_pair(std::move(s), settings_of(), true);
    start(pair);
    const std::uint64_t shown = count_shown(pair, 1);
    Material m = pair.scene->materials[1];
    m.diffuse = {0.2f, 0, 0};
    const std::uint64_t red = recolored_to(pair, 1, m);
    CHECK((is_textured ? red > shown + 10 : red == shown));
    m.diffuse = {0, 0, 0};
    CHECK(recolored_to(pair, 1, m) > shown + 10);
    m.diffuse = {0, 0.3f, 0.1f};
    CHECK(recolored_to(pair, 1, m) > shown + 10);
    m.emission = {0, 0, 0}, m.grazing = 0.25f;
    CHECK(recolored_to(pair, 1, m) == shown);
    m.diffuse_texture.texture = is_textured ? kNone : texture;
    CHECK(recolored_to(pair, 1, m) > shown + 10);
    CHECK(whole_because(pair) == "");
  }
}

// Goal: shadows follow a pane that lets other light pass, for every kind of light, and little else is traced. Method:
// the pane is out of sight.
TEST_CASE("recoloring_what_light_passes_changes_shadows") {
  for (Pane kind : {Pane::holes, Pane::blended, Pane::glass, Pane::absorbing})
    for (int light = 0; light < 4; ++light) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(light);
      auto s = pane_over_floor(kind);
      if (light == 0) add_light(s.get());
      if (light == 1) add_light(s.get(), LightKind::directional);
      if (light == 2) {
        Material lamp = matte({0, 0, 0});
        lamp.emission = {90, 90, 90};
        add_quad(s.get(), {-0.2f, 5, -0.2f}, {0.2f, 5, -0.2f}, {0.2f, 5, 0.2f}, {-0.2f, 5, 0.2f},
                 add_material(s.get(), lamp));
      }
      const bool is_unseen = kind != Pane::holes && light == 3;  // shadows from an environment do not know tints
      const Pair pair = make_pair(std::move(s), settings_of(), light == 3);
      start(pair);
      CHECK(count_shown(pair, 1) == 0);
      const Material changed = pane_changed(kind, pair.scene->materials[1]);
      Material first = changed;
      first.diffuse = {0.1f, 0.1f, 0.1f};  // in two steps
      for (TestRenderer* each : {pair.whole.get(), pair.coherent.get()})
        REQUIRE(change_material(&each->renderer, 1, first).ok);
      const std::uint64_t traced = recolored_to(pair, 1, changed);
      CHECK(whole_because(pair) == "");
      CHECK((is_unseen ? traced == 0 : traced > 20));
      CHECK(traced < (light == 3 ? pixel_count(pair) * 3 / 4 : pixel_count(pair) / 4));
      Material other = pair.scene->materials[1];
      other.diffuse = {0.3f, 0.5f, 0.4f};
      recolored_to(pair, 1, other);
      // The colour of its face alone; the tables know shadow rays that passed glass.
      const std::uint64_t face = recolored_to(pair, 1, pair.scene->materials[1]);
      CHECK((kind == Pane::holes ? face == 0 : face < pixel_count(pair) / 4));
    }
}

// Goal: light between surfaces follows a pane that lets other light pass. Method: a spotlight on a dark wall, whose
// virtual lights shine through the pane, and which shines on nothing else.
TEST_CASE("recoloring_what_virtual_lights_pass_changes_the_light") {
  auto s = box_on_floor(matte({0.7f, 0.7f, 0.7f}));
  s->with_uvs = true;
  const std::uint32_t dark = add_material(s.get(), matte({0.04f, 0.03f, 0.02f}));
  add_quad(s.get(), {-3, 0, -3}, {3, 0, -3}, {3, 4, -3}, {-3, 4, -3}, dark);
  Material pane = matte({0.5f, 0.5f, 0.5f});
  pane.alpha_mode = AlphaMode::mask;
  pane.diffuse_texture.texture = add_holes(s.get(), 0);
  add_holes(s.get(), 1);
  const std::uint32_t material = add_material(s.get(), pane);
  add_quad(s.get(), {-1, 0.2f, -2.2f}, {1, 0.2f, -2.2f}, {1, 1.2f, -2.2f}, {-1, 1.2f, -2.2f}, material);
  add_light(s.get(), LightKind::spot);
  s->lights[0].direction = normalize(Vec3{0, 2.5f, -3} - s->lights[0].position);
  s->lights[0].intensity = {9000, 9000, 9000}, s->lights[0].cos_inner = 0.995f, s->lights[0].cos_outer = 0.98f;
  Settings settings = settings_of();
  settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = 16;
  const Pair pair = make_pair(std::move(s), settings);
  start(pair);
  const std::uint64_t traced = recolored_to(pair, material, pane_changed(Pane::holes, pair.scene->materials[material]));
  CHECK(whole_because(pair) == "");
  CHECK((traced > count_shown(pair, material) + 100 && traced < pixel_count(pair)));
}

// Goal: what is known of the shadows of something that moves is forgotten where a pane over it opens. Method: a box
// moves in the shadow of a pane without holes; then the pane is all holes, and the box moves again.
TEST_CASE("recoloring_forgets_shadows_that_hid_others") {
  auto s = pane_over_floor(Pane::holes);
  s->materials[1].diffuse_texture.texture = add_texture(s.get(), 1, 1, {{{255, 255, 255, 255}}});
  const std::uint32_t hole = add_texture(s.get(), 1, 1, {{{255, 255, 255, 0}}});
  const std::uint32_t begin = vertex_count(*s);
  add_box(s.get(), {-0.2f, 1, -1.3f}, {0.2f, 1.4f, -0.9f}, 0);
  let_move(s.get(), begin);
  add_light(s.get());
  const Pair pair = make_pair(std::move(s), settings_of());
  start(pair);
  auto move = [&](float by) {
    for (Vec3& p : pair.scene->rest_positions) p.x += by;
    CHECK(same_frames(pair));
  };
  move(0.1f), move(0.1f);
  Material m = pair.scene->materials[1];
  m.diffuse_texture.texture = hole;
  CHECK(recolored_to(pair, 1, m) > 20);
  move(-0.1f), move(-0.1f), move(0.2f);
  CHECK(whole_because(pair) == "");
}

// Goal: a texture with levels is refused if the scene as opened shows none, whatever the filter is now. Method: the
// filter nearest, which does not read levels.
TEST_CASE("recoloring_by_a_first_texture_with_levels_is_refused") {
  auto s = pane_over_floor(Pane::holes);
  add_levels(s.get(), 1);
  add_light(s.get());
  Settings settings = settings_of();
  settings.texture_filter = TextureFilter::nearest;
  const Pair pair = make_pair(std::move(s), settings);
  Renderer* renderer = &pair.whole->renderer;
  Material m = pair.scene->materials[1];
  m.diffuse_texture.texture = 1;
  REQUIRE(check_recolored(renderer, 1, m).ok);
  const Status status = change_material(renderer, 1, m);
  CHECK(!status.ok);
  CHECK(std::string(status.message).find("mip-map") != std::string::npos);
  m.diffuse_texture.texture = 0;
  CHECK(change_material(renderer, 1, m).ok);
}

// Goal: a body that becomes opaque casts a shadow, from an environment, too. Method: another remains glass.
TEST_CASE("recoloring_glass_until_it_is_opaque_casts_shadows") {
  for (bool with_environment : {false, true}) {
    auto s = pane_over_floor(Pane::glass);
    if (!with_environment) add_light(s.get());
    const Pair pair = make_pair(std::move(s), settings_of(), with_environment);
    start(pair);
    Material m = pair.scene->materials[1];
    m.transmission = {0, 0, 0};
    CHECK(recolored_to(pair, 1, m) > 20);
    CHECK(recolored_to(pair, 1, pair.scene->materials[1]) > 20);
    CHECK(whole_because(pair) == "");
  }
}

// Goal: what is seen through holes follows them. Method: another texture with other holes, in front of the camera;
// perspective and orthographic.
TEST_CASE("recoloring_holes_is_seen_through") {
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    auto s = pane_over_floor(Pane::holes);
    add_light(s.get());
    s->cameras[0].eye = {0, 6, 0.5f}, s->cameras[0].target = {0, 0, 0};
    s->cameras[0].projection = projection, s->cameras[0].vertical_extent = 3;
    s->cameras[0].vertical_fov = 0.6f;
    const Pair pair = make_pair(std::move(s), settings_of(2), true);
    start(pair);
    const std::uint64_t shown = count_shown(pair, 1);
    CHECK(shown > 100);
    CHECK(recolored_to(pair, 1, pane_changed(Pane::holes, pair.scene->materials[1])) > shown + 100);
    CHECK(whole_because(pair) == "");
  }
}

// Goal: lamps are dimmed, switched off and on as lights are. Method: a lamp that cannot reach the top of a box.
TEST_CASE("recoloring_a_lamp_dims_it") {
  for (std::uint32_t points : {2u, 9u}) {
    auto s = box_on_floor(matte({0.5f, 0.5f, 0.5f}));
    Material lamp = matte({0, 0, 0});
    lamp.emission = {9, 8, 7}, lamp.double_sided = 0;
    add_quad(s.get(), {-2.5f, 0.1f, -0.4f}, {-2.5f, 0.8f, -0.4f}, {-2.5f, 0.8f, 0.4f}, {-2.5f, 0.1f, 0.4f},
             add_material(s.get(), lamp));
    add_light(s.get());
    Settings settings = settings_of();
    settings.points_per_area_light = points;
    const Pair pair = make_pair(std::move(s), settings);
    start(pair);
    for (float share : {0.5f, 0.0f, 0.0f, 0.25f, 1.0f}) {
      CAPTURE(share);
      Material m = pair.scene->materials[2];
      const bool changes = pair.coherent->renderer.materials.current[2].emission != m.emission * share;
      m.emission = m.emission * share;
      const std::uint64_t traced = recolored_to(pair, 2, m);
      CHECK(whole_because(pair) == "");
      CHECK((traced > 100) == changes);
      CHECK(traced < pixel_count(pair) * 3 / 4);
      CHECK(pair.coherent->renderer.frame.lights.points.count == points + 1);
    }
  }
}

// Goal: what reaches too far to follow makes a whole frame, with its reason. Method: one case each; in the last, a pane
// moves and gets other holes at once.
TEST_CASE("recoloring_that_reaches_far_makes_whole_frames") {
  auto is_whole = [](std::unique_ptr<GeneratedScene> scene, std::uint32_t material, Vec3 Material::*color,
                     const Vec3& changed, const char* reason) {
    add_light(scene.get());
    const Pair pair = make_pair(std::move(scene), settings_of());
    start(pair);
    Material m = pair.scene->materials[material];
    m.*color = changed;
    CHECK(recolored_to(pair, material, m) == pixel_count(pair));
    CHECK(whole_because(pair) == reason);
  };
  Material floor = matte({0.2f, 0.2f, 0.2f});
  floor.mirror = {0.5f, 0.5f, 0.5f};
  is_whole(box_on_floor(floor), 1, &Material::diffuse, {0.95f, 0.95f, 0.95f},
           "the brightest light on a surface changed");
  auto body = pane_over_floor(Pane::absorbing);
  add_box(body.get(), {-6, -6, -6}, {6, 6, 6}, 2);
  is_whole(std::move(body), 2, &Material::absorption, {0.01f, 0.02f, 0.01f},
           "the body around the camera was recoloured");
  auto s = pane_over_floor(Pane::holes);
  let_move(s.get(), 4);
  add_light(s.get());
  const Pair pair = make_pair(std::move(s), settings_of());
  start(pair);
  for (Vec3& p : pair.scene->rest_positions) p.x += 0.3f;
  CHECK(recolored_to(pair, 1, pane_changed(Pane::holes, pair.scene->materials[1])) == pixel_count(pair));
  CHECK(whole_because(pair) == "a recoloured surface moved");
  for (Vec3& p : pair.scene->rest_positions) p.x += 0.3f;
  Material m = pair.coherent->renderer.materials.current[1];
  m.diffuse = {0.1f, 0.2f, 0.3f};
  CHECK(recolored_to(pair, 1, m) < pixel_count(pair));
}

// Goal: a body of many triangles is followed, too. Method: spheres of a few and of thousands of triangles turn opaque
// and clear again.
TEST_CASE("recoloring_large_meshes_is_followed") {
  for (int columns : {6, 40, 160}) {
    auto s = pane_over_floor(Pane::glass);
    Material glass = s->materials[1];
    glass.thin = 0;
    const std::uint32_t material = add_material(s.get(), glass);
    add_sphere(s.get(), {1.2f, 2, -1}, 0.5f, columns, columns / 2, material);
    add_light(s.get());
    const Pair pair = make_pair(std::move(s), settings_of());
    start(pair);
    const Vec3 clear = glass.transmission;
    for (const Vec3& transmission : {Vec3{0, 0, 0}, clear}) {
      glass.transmission = transmission;
      const std::uint64_t traced = recolored_to(pair, material, glass);
      CHECK(whole_because(pair) == "");
      CHECK(traced > 20);
      CHECK(traced < pixel_count(pair) / 2);
    }
  }
}
