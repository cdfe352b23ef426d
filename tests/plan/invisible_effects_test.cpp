// Effects that a scene states but no picture shows: the plan reads values, not flags (HARDCASES row 73).
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "brdf/brdf_list.h"
#include "plan/plan_effects.h"
#include "support/generated_scene.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

using Texels = std::vector<std::array<int, 4>>;

constexpr std::array<int, 4> kBlack = {{0, 0, 0, 255}}, kWhite = {{255, 255, 255, 255}}, kFlat = {{128, 128, 255, 255}},
                             kGreenBlue = {{0, 255, 255, 255}}, kRedGreen = {{255, 255, 0, 255}};

// Four texels, of which the last may differ.
std::uint32_t texture_of(GeneratedScene* s, const std::array<int, 4>& all, const std::array<int, 4>& last) {
  s->with_uvs = true;
  return add_texture(s, 2, 2, {all, all, all, last});
}

// A floor with a box on it, under a lamp and ambient light.
std::unique_ptr<GeneratedScene> make_scene() {
  auto s = std::make_unique<GeneratedScene>();
  const std::uint32_t floor = add_material(s.get(), Material()), box = add_material(s.get(), Material());
  add_quad(s.get(), {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, floor);
  add_box(s.get(), {-1, 0, -1}, {1, 1, 1}, box);
  s->lights.emplace_back();
  s->lights[0].position = {1, 3, 2}, s->lights[0].intensity = {9, 9, 9};
  s->material_maps.resize(2);
  s->scene.info.ambient = {0.1f, 0.1f, 0.1f};
  aim(s.get(), {2, 2, 4}, {0, 0.5f, 0}, 50);
  return s;
}

EffectDecision decision(const GeneratedScene& s, Effect effect) {
  return plan_effects(s.scene, Settings()).decisions[static_cast<int>(effect)];
}

bool shows_the_same_by_all(const GeneratedScene& s) {
  Settings settings;
  settings.width = 32, settings.height = 24;
  const Picture automatic = render_picture(s.scene, settings);
  settings.forced_on = kAllEffects;
  return same_picture(automatic, render_picture(s.scene, settings));
}

// A kind of content that may be invisible; `visible` makes it show, however little.
struct Case {
  const char* name;
  Effect effect;
  const char* reason;
  std::function<void(GeneratedScene* s, bool visible)> add;
};

void add_light(GeneratedScene* s, LightKind kind, const Vec3& intensity, const Vec3& position, float range) {
  Light light;
  light.kind = kind, light.intensity = intensity, light.position = position, light.range = range;
  s->lights.push_back(light);
}

// Holds the node of the box at rest, or moves it at the second key.
void add_animation(GeneratedScene* s, bool moves) {
  s->nodes.emplace_back();
  MovingMesh mesh = {};
  mesh.vertex_begin = 4, mesh.vertex_count = static_cast<std::uint32_t>(s->positions.size()) - 4;
  s->rest_positions.assign(s->positions.begin() + 4, s->positions.end());
  s->moving_meshes.push_back(mesh);
  s->key_times = {0, 1};
  s->key_values = {0, 0, 0, moves ? 0x1p-8f : 0, 0, 0};
  Channel channel = {};
  channel.key_count = 2, channel.path = ChannelPath::translation, channel.interpolation = Interpolation::linear;
  s->channels.push_back(channel);
  s->animations.push_back({0, 1, 1});
}

const Case kCases[] = {
    {"black emission", Effect::emission, "none of 2 materials emit (1 with a black texture)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].emission = {1, 1, 1};
       s->materials[1].emission_texture.texture = texture_of(s, kBlack, visible ? kWhite : kBlack);
     }},
    {"black lamps", Effect::area_light, "none of 2 materials emit light (1 with a black texture)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].emission = {1, 1, 1};
       s->materials[1].emission_texture.texture = texture_of(s, kBlack, {{0, visible, 0, 255}});
     }},
    {"opaque blend", Effect::alpha_blend, "none of 2 materials blend with the background (1 with alpha 1)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].alpha_mode = AlphaMode::blend;
       s->materials[1].diffuse_texture.texture = texture_of(s, kWhite, {{255, 255, 255, visible ? 254 : 255}});
     }},
    {"opaque vertices", Effect::alpha_blend, "none of 2 materials blend with the background (1 with alpha 1)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].alpha_mode = AlphaMode::blend;
       s->with_colors = true;
       s->colors.assign(s->positions.size(), {65535, 65535, 65535, 65535});
       s->colors[4].a = visible ? 65534 : 65535;
       s->colors[0].a = 0;  // of the opaque floor
     }},
    {"mask without holes", Effect::alpha_mask, "none of 2 materials have holes (1 with alpha above its cut-off)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].alpha_mode = AlphaMode::mask, s->materials[1].alpha_cutoff = 128.5f / 255;
       s->materials[1].diffuse_texture.texture = texture_of(s, kWhite, {{255, 255, 255, visible ? 128 : 129}});
     }},
    {"mask at its cut-off", Effect::alpha_mask, "none of 2 materials have holes (1 with alpha above its cut-off)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].alpha_mode = AlphaMode::mask, s->materials[1].opacity = 0.5f;
       if (visible) s->materials[1].alpha_cutoff = 0x1.000002p-1f;
     }},
    {"flat normal map", Effect::normal_map, "none of 2 materials have a normal texture (1 with a flat one)",
     [](GeneratedScene* s, bool visible) {
       s->material_maps[1].normal.texture = texture_of(s, kFlat, {{visible ? 129 : 128, 128, 255, 255}});
     }},
    {"normal map of scale 0", Effect::normal_map, "none of 2 materials have a normal texture (1 with a flat one)",
     [](GeneratedScene* s, bool visible) {
       s->material_maps[1].normal.texture = texture_of(s, kFlat, kWhite);
       s->material_maps[1].normal_scale = visible ? 0x1p-6f : 0;
     }},
    {"white occlusion", Effect::occlusion, "none of 2 materials have an occlusion texture (1 with a white one)",
     [](GeneratedScene* s, bool visible) {
       s->material_maps[1].occlusion.texture = texture_of(s, kWhite, {{visible ? 254 : 255, 0, 0, 255}});
     }},
    {"white vertices", Effect::vertex_color, "no vertex has a colour (28 white)",
     [](GeneratedScene* s, bool visible) {
       s->with_colors = true;
       s->colors.assign(s->positions.size(), {65535, 65535, 65535, 0});
       s->colors[4].g = visible ? 65534 : 65535;
     }},
    {"coat under black", Effect::clear_coat, "none of 2 materials have a clear coat (1 with a black texture)",
     [](GeneratedScene* s, bool visible) {
       s->clear_coats.resize(2);
       s->clear_coats[1].strength = 1, s->clear_coats[1].roughness = s->clear_coats[1].roughness_low = 0.4f;
       s->clear_coats[1].strength_texture.texture = texture_of(s, kGreenBlue, {{visible, 255, 255, 255}});
     }},
    {"sheen under black", Effect::sheen, "none of 2 materials have a sheen (1 with a black texture)",
     [](GeneratedScene* s, bool visible) {
       s->sheens.resize(2);
       s->sheens[1].color = {1, 1, 1}, s->sheens[1].roughness = s->sheens[1].roughness_low = 0.4f;
       s->sheens[1].color_texture.texture = texture_of(s, kBlack, {{0, 0, visible, 255}});
     }},
    {"film under black", Effect::iridescence, "none of 2 materials have a thin film (1 with a black texture)",
     [](GeneratedScene* s, bool visible) {
       s->iridescences.resize(2);
       s->iridescences[1].strength = 1;
       s->iridescences[1].strength_texture.texture = texture_of(s, kGreenBlue, {{visible, 255, 255, 255}});
     }},
    {"leaf of alpha 0", Effect::diffuse_transmission,
     "none of 2 materials pass light diffusely (1 with a texture of alpha 0)",
     [](GeneratedScene* s, bool visible) {
       s->diffuse_transmissions.resize(2);
       s->diffuse_transmissions[1].strength = 1;
       s->diffuse_transmissions[1].strength_texture.texture = texture_of(s, {{9, 9, 9, 0}}, {{9, 9, 9, visible}});
     }},
    {"grain under black", Effect::anisotropy, "none of 2 materials have a grain (1 with a black texture)",
     [](GeneratedScene* s, bool visible) {
       s->materials[1].brdf = kGgx, s->materials[1].specular = {0.5f, 0.5f, 0.5f}, s->materials[1].roughness = 0.2f;
       s->grains.resize(2);
       s->grains[1].direction = {1, 0};
       s->grains[1].texture.texture = texture_of(s, kRedGreen, {{255, 255, visible, 255}});
     }},
    {"zero normals", Effect::smooth_normal, "no vertex has a normal of its own",
     [](GeneratedScene* s, bool visible) {
       s->with_normals = true;
       if (visible) s->normals[4] = {0, 0x1p-4f, 1};
     }},
    {"dark spot", Effect::spot_light, "no spot light (1 with intensity 0)",
     [](GeneratedScene* s, bool visible) {
       add_light(s, LightKind::spot, {0, visible ? 0x1p-10f : 0, 0}, {0, 3, 0}, 0);
     }},
    {"distant spot", Effect::spot_light, "no spot light (1 out of range)",
     [](GeneratedScene* s, bool visible) {
       add_light(s, LightKind::spot, {9, 9, 9}, {0, 4, 0}, visible ? 3.001f : 3.0f);
       s->lights.back().range *= 1 - (visible ? 0 : 0x1p-18f);
     }},
    {"still animation", Effect::animation, "nothing moves (1 animation holds still)",
     [](GeneratedScene* s, bool visible) { add_animation(s, visible); }},
    {"lamp without area", Effect::area_light, "none of 2 materials emit light",
     [](GeneratedScene* s, bool visible) {
       Material lamp;
       lamp.emission = {5, 5, 5};
       add_material(s, lamp);
       s->material_maps.resize(3);
       add_quad(s, {0, 2, 0}, {1, 2, 0}, {1, 2, visible ? 0x1p-6f : 0}, {0, 2, visible ? 0x1p-6f : 0}, 2);
     }},
};

}  // namespace

// Goal: an effect without any visible result is off, and its reason says why; with one texel, vertex, key or unit in
// the last place that shows, it is on. Method: each kind of content in a small scene, both ways, against --effects all.
TEST_CASE("hard_73_effects_that_show_nothing_are_off") {
  for (const Case& row : kCases)
    for (const bool visible : {false, true}) {
      CAPTURE(row.name);
      CAPTURE(visible);
      auto s = make_scene();
      row.add(s.get(), visible);
      s->bind();
      const EffectDecision d = decision(*s, row.effect);
      CHECK(d.on == visible);
      if (!visible) CHECK(std::string(d.reason) == row.reason);
      CHECK(shows_the_same_by_all(*s));
    }
}

namespace {

// An effect of a scene, and whether any picture can show it.
struct Asked {
  const GeneratedScene* scene;
  Effect effect;
  bool visible;
};

// Asks what a scene states instead of what it shows, as renderers do that choose their shaders by flags.
bool is_on_by_flags(const Asked& asked) {
  const GeneratedScene& s = *asked.scene;
  auto any_material = [&](auto test) { return std::any_of(s.materials.begin(), s.materials.end(), test); };
  auto any_map = [&](auto test) { return std::any_of(s.material_maps.begin(), s.material_maps.end(), test); };
  switch (asked.effect) {
    case Effect::emission:
    case Effect::area_light:
      return any_material([](const Material& m) { return !is_zero(m.emission); });
    case Effect::alpha_blend:
      return any_material([](const Material& m) { return m.alpha_mode == AlphaMode::blend; });
    case Effect::alpha_mask:
      return any_material([](const Material& m) { return m.alpha_mode == AlphaMode::mask; });
    case Effect::normal_map:
      return any_map([](const MaterialMaps& m) { return m.normal.texture != kNone; });
    case Effect::occlusion:
      return any_map([](const MaterialMaps& m) { return m.occlusion.texture != kNone; });
    case Effect::smooth_normal:
      return s.with_normals;
    case Effect::vertex_color:
      return s.with_colors;
    case Effect::clear_coat:
      return std::any_of(s.clear_coats.begin(), s.clear_coats.end(), [](const ClearCoat& c) { return c.strength > 0; });
    case Effect::iridescence:
      return std::any_of(s.iridescences.begin(), s.iridescences.end(),
                         [](const Iridescence& film) { return film.strength > 0; });
    case Effect::diffuse_transmission:
      return std::any_of(s.diffuse_transmissions.begin(), s.diffuse_transmissions.end(),
                         [](const DiffuseTransmission& passing) { return passing.strength > 0; });
    case Effect::sheen:
      return std::any_of(s.sheens.begin(), s.sheens.end(), [](const Sheen& c) { return c.color.x > 0; });
    case Effect::anisotropy:
      return std::any_of(s.grains.begin(), s.grains.end(), [](const Grain& g) { return g.direction.x != 0; });
    case Effect::spot_light:
      return std::any_of(s.lights.begin(), s.lights.end(), [](const Light& l) { return l.kind == LightKind::spot; });
    case Effect::animation:
      return !s.animations.empty();
    default:
      FAIL("no flag");
      return false;
  }
}

}  // namespace

// Goal: an effect is on if and only if a picture can show it, where flags turn on what is invisible. Method: the cases
// above, asked many times.
TEST_CASE("hard_73_effects_by_flags") {
  std::vector<std::unique_ptr<GeneratedScene>> scenes;
  std::vector<Asked> asked;
  for (const Case& row : kCases)
    for (const bool visible : {false, true}) {
      scenes.push_back(make_scene());
      row.add(scenes.back().get(), visible);
      scenes.back()->bind();
      for (int i = 0; i < gate_share(10, 1000); ++i) asked.push_back({scenes.back().get(), row.effect, visible});
    }
  auto by_ours = [](const Asked& a) { return decision(*a.scene, a.effect).on; };
  auto is_wrong = [](const Asked& a, bool on) { return on != a.visible; };
  const Answers ours = time_answers(asked, by_ours, is_wrong), flags = time_answers(asked, is_on_by_flags, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(2 * flags.wrong == asked.size());
  count_beside("by flags", "plan of a small scene", asked.size(), flags, ours);
  count_hard(asked.size(), ours.wrong, "on if and only if a picture shows it");
}

// Goal: without the effect, a surface that blends is opaque, also where glass lets light through. Method: a pane of
// alpha 1 between a floor and the sun, beside a sheet of glass.
TEST_CASE("hard_73_opaque_blends_hide_the_sun_beside_glass") {
  GeneratedScene s;
  Material pane, glass;
  pane.alpha_mode = AlphaMode::blend;
  glass.transmission = {0.9f, 0.9f, 0.9f}, glass.diffuse = {0, 0, 0}, glass.thin = 1;
  add_material(&s, Material()), add_material(&s, pane), add_material(&s, glass);
  add_quad(&s, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, 0);
  add_quad(&s, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, 1);
  add_quad(&s, {-5, 2, 1}, {-4, 2, 1}, {-4, 2, -1}, {-5, 2, -1}, 2);
  add_light(&s, LightKind::directional, {1, 1, 1}, {0, 0, 0}, 0);
  aim(&s, {0, 0.5f, 4}, {0, 0, 0}, 50);
  s.bind();
  CHECK_FALSE(decision(s, Effect::alpha_blend).on);
  CHECK(shows_the_same_by_all(s));
  const auto test = make_renderer(s.scene, settings_for(0, 8, 6));
  CHECK(trace_ray(test->renderer, {0, 0.5f, 2}, {0, -0.25f, -1}) == Vec3{0, 0, 0});
}
