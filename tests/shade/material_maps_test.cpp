// Materials that change from point to point.
#include <doctest/doctest.h>

#include <cstring>

#include "plan/radiance_bounds.h"
#include "scene/metallic_roughness.h"
#include "shade_helpers.h"

using namespace pocketray;

namespace {

const MetallicRoughness kModel = {{0.9f, 0.6f, 0.3f}, {0.04f, 0.06f, 0.08f}, 0.8f};

// A sheet under a directional light, ambient light and a background, its texture (0, 51, 255 | 0, 204, 0) if it is
// mapped, else a single material.
void make_sheet(GeneratedScene* s, const Material* plain, bool tinted) {
  const std::uint32_t material = add_material(s, plain ? *plain : Material());
  add_sheet(s, 0, material, false, 1);
  if (!plain)
    add_map(s, material, kModel,
            add_texture(s, 2, 1, {{9, 51, 255, 9}, {9, 204, 0, 9}}, Wrap::clamp, Wrap::clamp, true));
  if (tinted) s->materials[material].diffuse_texture.texture = add_texture(s, 1, 1, {{255, 188, 99, 255}});
  s->with_uvs = true;
  s->lights.resize(1);
  s->lights[0].kind = LightKind::directional;
  s->lights[0].direction = normalize(Vec3{-1, -2, -3});
  s->scene.info.ambient = {0.2f, 0.3f, 0.4f}, s->scene.info.background = {0.5f, 0.3f, 0.1f};
}

bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

// Goal: a point of a mapped material has the lobes of its texel. Method: the halves of a sheet, metal with a mirror and
// rough plastic, against sheets of materials with these values: the same bits, with and without a texture of colours.
TEST_CASE("metallic_roughness_map_equals_its_values") {
  for (bool tinted : {false, true}) {
    GeneratedScene mapped;
    make_sheet(&mapped, nullptr, tinted);
    auto t = ray_renderer(&mapped);
    CHECK(has(t->renderer.effects.mask, Effect::metallic_roughness));
    for (bool right : {false, true}) {
      Material m = mapped.materials[0];
      set_lobes(kModel, right ? 0.0f : 1.0f, (right ? 204.0f : 51.0f) / 255, 0, &m);
      GeneratedScene plain;
      make_sheet(&plain, &m, tinted);
      auto p = ray_renderer(&plain);
      for (float x : {0.1f, 0.5f, 0.8f}) {
        const Vec3 eye = {1, 0.5f, 2}, at = {right ? x : -x, 0.3f, 0};
        CAPTURE(tinted);
        CAPTURE(right);
        CHECK(same_bits(look(*t, eye, at), look(*p, eye, at)));
      }
    }
  }
}

// Goal: specular textures dim a dielectric's reflectance by alpha, at normal incidence by their colour as well, and
// leave a metal alone. Method: a sheet against one whose model has these values; without a metallic-roughness texture.
TEST_CASE("specular_textures_dim_dielectrics") {
  for (float metallic : {0.0f, 0.5f, 1.0f}) {
    GeneratedScene mapped;
    make_sheet(&mapped, nullptr, false);
    MaterialMaps& maps = mapped.material_maps[0];
    maps.metallic_roughness.texture = kNone, maps.metallic = metallic, maps.roughness = 0.5f;
    maps.specular.texture = maps.specular_color.texture = add_texture(&mapped, 1, 1, {{255, 188, 99, 51}});
    Material m = mapped.materials[0];
    MetallicRoughness model = kModel;
    model.dielectric = model.dielectric * Vec3{1, 0.502886f, 0.124772f} * 0.2f, model.grazing *= 0.2f;
    set_lobes(model, metallic, 0.5f, 0, &m);
    GeneratedScene plain;
    make_sheet(&plain, &m, false);
    const Vec3 eye = {1, 0.5f, 2}, at = {0.3f, 0.3f, 0};
    const Vec3 found = look(*ray_renderer(&mapped), eye, at), expected = look(*ray_renderer(&plain), eye, at);
    CAPTURE(metallic);
    for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(expected[c]).epsilon(1e-5));
  }
}

// Goal: a texture that holds metallic, roughness and occlusion is looked up once, with the light of two look-ups; used
// twice with different transforms, it is two. Method: the same bits as with a copy of it, as one use and as two.
TEST_CASE("maps_may_share_a_texture") {
  for (bool turned : {false, true}) {
    GeneratedScene shared, apart;
    for (GeneratedScene* s : {&shared, &apart}) {
      make_sheet(s, nullptr, false);
      const std::uint32_t copy =
          add_texture(s, 2, 1, {{9, 51, 255, 9}, {200, 204, 0, 9}}, Wrap::clamp, Wrap::clamp, true);
      MaterialMaps& maps = s->material_maps[0];
      maps.metallic_roughness.texture = copy;
      maps.occlusion.texture = s == &shared ? copy : copy + 1;
      add_texture(s, 2, 1, {{9, 51, 255, 9}, {200, 204, 0, 9}}, Wrap::clamp, Wrap::clamp, true);
      if (turned) maps.occlusion.m[0][0] = -1, maps.occlusion.m[0][2] = 1;
    }
    const Vec3 eye = {1, 0.5f, 2}, at = {0.3f, 0.3f, 0};
    CAPTURE(turned);
    CHECK(same_bits(look(*ray_renderer(&shared), eye, at), look(*ray_renderer(&apart), eye, at)));
  }
}

// Goal: a plan without the effect shows the material's own lobes, those of the means. Method: the same bits as without
// the map.
TEST_CASE("metallic_roughness_map_can_be_left_out") {
  GeneratedScene mapped, plain;
  make_sheet(&mapped, nullptr, false);
  make_sheet(&plain, &mapped.materials[0], false);
  mapped.bind(), plain.bind();
  Settings settings;
  settings.width = settings.height = 1, settings.cut_off_levels = 0;
  aim(&mapped, {0, 0, 50}, {0, 0, 0}, 40), aim(&plain, {0, 0, 50}, {0, 0, 0}, 40);
  mapped.bind(), plain.bind();
  auto p = make_renderer(plain.scene, settings);
  settings.forced_off = bit(Effect::metallic_roughness);
  auto t = make_renderer(mapped.scene, settings);
  CHECK(same_bits(look(*t, {1, 0.5f, 2}, {0.5f, 0.3f, 0}), look(*p, {1, 0.5f, 2}, {0.5f, 0.3f, 0})));
}

// Goal: bilinear look-ups blend the numbers as stored, not as colours. Method: halfway between black and white texels,
// the diffuse albedo of a half metal under ambient light alone.
TEST_CASE("metallic_roughness_map_is_linear") {
  GeneratedScene s;
  const std::uint32_t material = add_material(&s, Material());
  add_sheet(&s, 0, material, false, 1);
  add_map(&s, material, {{0.8f, 0.8f, 0.8f}, {0, 0, 0}, 0},
          add_texture(&s, 2, 1, {{0, 255, 0, 255}, {0, 255, 255, 255}}));
  s.with_uvs = true;
  s.scene.info.ambient = {1, 1, 1};
  auto t = ray_renderer(&s);
  t->renderer.frame.settings.indirect = IndirectChoice::automatic;
  Material half;
  set_lobes({{0.8f, 0.8f, 0.8f}, {0, 0, 0}, 0}, 0.5f, 1, 0, &half);
  half.brdf = s.materials[0].brdf;
  GeneratedScene plain;
  add_sheet(&plain, 0, add_material(&plain, half), false, 1);
  plain.scene.info.ambient = {1, 1, 1};
  auto p = ray_renderer(&plain);
  CHECK(look(*t, {0, 0, 2}, {0, 0, 0}).x == doctest::Approx(look(*p, {0, 0, 2}, {0, 0, 0}).x).epsilon(1e-5));
}

// Goal: the bounds of a mapped material hold for all its values, and the plan's for its radiance. Method: random ranges
// and values within; the bound of a sheet whose mean neither mirrors nor is metallic, but whose map does both.
TEST_CASE("lobe_bounds_cover_every_value_of_the_map") {
  Rng rng = make_rng(5);
  for (int i = 0; i < 2000; ++i) {
    auto next = [&] { return next_float(&rng); };
    MaterialMaps maps;
    maps.model = {{next(), next(), next()}, {next(), next(), next()}, next()};
    maps.metallic_roughness.texture = 0;
    maps.metallic_high = next(), maps.metallic_low = maps.metallic_high * next();
    maps.roughness_high = next() * next(), maps.roughness_low = maps.roughness_high * next();
    const Material most = lobe_bounds(Material(), maps, nullptr);
    for (int k = 0; k < 10; ++k) {
      Material m;
      set_lobes(maps.model, maps.metallic_low + (maps.metallic_high - maps.metallic_low) * next(),
                maps.roughness_low + (maps.roughness_high - maps.roughness_low) * next(), 0, &m);
      constexpr float kRounded = 1.000001f;
      for (int c = 0; c < 3; ++c) {
        CHECK(m.diffuse[c] <= most.diffuse[c] * kRounded);
        CHECK(m.specular[c] <= most.specular[c] * kRounded);
        CHECK(m.mirror[c] <= most.mirror[c] * kRounded);
      }
      CHECK(m.grazing <= most.grazing * kRounded);
      CHECK(m.roughness * kRounded >= most.roughness);
    }
  }
  GeneratedScene s;
  make_sheet(&s, nullptr, false);
  s.scene.info.background = {3, 3, 3};
  set_lobes(kModel, 0, 0.9f, 0, &s.materials[0]);
  auto t = ray_renderer(&s);
  const float bound = radiance_bounds(t->renderer.frame).after[0];
  CHECK(bound >= max_component(look(*t, {1, 0.5f, 2}, {-0.5f, 0.3f, 0})));
  t->renderer.frame.mask &= ~bit(Effect::metallic_roughness);
  CHECK(bound > 10 * radiance_bounds(t->renderer.frame).after[0]);  // the bound of the mean's lobes would not do
}
