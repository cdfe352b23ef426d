// Effects called for by textures of layers, glass and leaves.
#include <doctest/doctest.h>

#include <array>

#include "plan/plan_effects.h"
#include "support/generated_scene.h"

using namespace pocketray;

// Goal: textures of a clear coat call for what they read, and only while there is a coat. Method: a coat with each of
// its textures, which has levels and reads the second coordinates; without strength.
TEST_CASE("plan_effects_follow_the_textures_of_coats") {
  for (TextureUse ClearCoat::*use : {&ClearCoat::strength_texture, &ClearCoat::roughness_texture, &ClearCoat::normal})
    for (float strength : {1.0f, 0.0f}) {
      GeneratedScene s;
      add_quad(&s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(&s, Material()));
      const std::uint32_t texture = add_texture(&s, 2, 2, std::vector<std::array<int, 4>>(4, {{9, 9, 9, 255}}));
      add_levels(&s, texture);
      const bool is_normal = use == &ClearCoat::normal;
      s.textures[texture].uv_set = !is_normal;
      s.clear_coats.resize(1);
      s.clear_coats[0].strength = strength, (s.clear_coats[0].*use).texture = texture;
      s.with_uvs = s.with_second_uvs = true;
      s.bind();
      const EffectMask mask = plan_effects(s.scene, Settings()).mask;
      CHECK(has(mask, Effect::clear_coat) == (strength > 0));
      CHECK(has(mask, Effect::mip_map) == (strength > 0));
      CHECK(has(mask, Effect::second_uv) == (strength > 0 && !is_normal));
      CHECK(has(mask, Effect::normal_map) == (strength > 0 && is_normal));
    }
}

// Goal: textures of a sheen call for what they read, and only while it has a colour. Method: as for coats.
TEST_CASE("plan_effects_follow_the_textures_of_sheens") {
  for (TextureUse Sheen::*use : {&Sheen::color_texture, &Sheen::roughness_texture})
    for (float color : {1.0f, 0.0f}) {
      GeneratedScene s;
      add_quad(&s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(&s, Material()));
      const std::uint32_t texture = add_texture(&s, 2, 2, std::vector<std::array<int, 4>>(4, {{9, 9, 9, 255}}));
      add_levels(&s, texture);
      s.textures[texture].uv_set = 1;
      s.sheens.resize(1);
      s.sheens[0].color = {0, color, 0}, (s.sheens[0].*use).texture = texture;
      s.with_uvs = s.with_second_uvs = true;
      s.bind();
      const EffectMask mask = plan_effects(s.scene, Settings()).mask;
      CHECK(has(mask, Effect::sheen) == (color > 0));
      CHECK(has(mask, Effect::mip_map) == (color > 0));
      CHECK(has(mask, Effect::second_uv) == (color > 0));
    }
}

// Goal: textures of a film and of glass call for what they read, and only while it shows. Method: as for coats.
TEST_CASE("plan_effects_follow_the_textures_of_films_and_glass") {
  for (int slot = 0; slot < 4; ++slot)
    for (float share : {1.0f, 0.0f}) {
      GeneratedScene s;
      Material m;
      m.brdf = kGgx, m.thin = 1, m.specular = {0.04f, 0.04f, 0.04f}, m.transmission = {share, share, share};
      add_quad(&s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(&s, m));
      const std::uint32_t texture = add_texture(&s, 2, 2, std::vector<std::array<int, 4>>(4, {{9, 9, 9, 255}}));
      add_levels(&s, texture);
      s.textures[texture].uv_set = 1;
      s.material_maps.resize(1), s.glass_maps.resize(1), s.iridescences.resize(1);
      s.material_maps[0].model = {{1, 1, 1}, {0.04f, 0.04f, 0.04f}, 1};
      (slot < 2 ? s.iridescences[0].strength : s.glass_maps[0].transmission) = share;
      TextureUse* uses[] = {&s.iridescences[0].strength_texture, &s.iridescences[0].thickness_texture,
                            &s.glass_maps[0].transmission_texture, &s.glass_maps[0].thickness_texture};
      uses[slot]->texture = texture;
      s.with_uvs = s.with_second_uvs = true;
      s.bind();
      const EffectMask mask = plan_effects(s.scene, Settings()).mask;
      CAPTURE(slot);
      CHECK(has(mask, slot < 2 ? Effect::iridescence : Effect::transmission_map) == (share > 0));
      CHECK(has(mask, Effect::mip_map) == (share > 0));
      CHECK(has(mask, Effect::second_uv) == (share > 0));
    }
}

// Goal: textures of diffuse transmission call for what they read, and only while light passes. Method: as for coats.
TEST_CASE("plan_effects_follow_the_textures_of_leaves") {
  for (TextureUse DiffuseTransmission::*use :
       {&DiffuseTransmission::strength_texture, &DiffuseTransmission::color_texture})
    for (float strength : {1.0f, 0.0f}) {
      GeneratedScene s;
      add_quad(&s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(&s, Material()));
      const std::uint32_t texture = add_texture(&s, 2, 2, std::vector<std::array<int, 4>>(4, {{9, 9, 9, 9}}));
      add_levels(&s, texture);
      s.textures[texture].uv_set = 1;
      s.diffuse_transmissions.resize(1);
      s.diffuse_transmissions[0].strength = strength, (s.diffuse_transmissions[0].*use).texture = texture;
      s.with_uvs = s.with_second_uvs = true, s.bind();
      const EffectMask mask = plan_effects(s.scene, Settings()).mask;
      CHECK(has(mask, Effect::diffuse_transmission) == (strength > 0));
      CHECK(has(mask, Effect::mip_map) == (strength > 0));
      CHECK(has(mask, Effect::second_uv) == (strength > 0));
    }
}
