// Import leaves out contents that no picture shows.
#include <algorithm>
#include <cmath>
#include <functional>

#include "brdf/brdf_list.h"
#include "desktop/import/reduce.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "plan/plan_effects.h"
#include "scene/baked.h"
#include "scene/metallic_roughness.h"
#include "scene/texture_levels.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// PNGs of one texel.
const char* const kBlackPng =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNgYGD4DwABBAEAgLvRWwAAAABJRU5ErkJggg==";
const char* const kGreyPng =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaGj4DwAFhAKAU5N0NgAAAABJRU5ErkJggg==";

SceneArrays arrays_of(const GeneratedScene& s) {
  SceneArrays a;
  auto copy = [](const auto& from, auto* to) { to->assign(from.begin(), from.end()); };
  const Scene& scene = s.scene;
  a.info = scene.info;
  copy(scene.positions, &a.positions), copy(scene.normals, &a.normals), copy(scene.uvs, &a.uvs);
  copy(scene.second_uvs, &a.second_uvs), copy(scene.colors, &a.colors), copy(scene.triangles, &a.triangles);
  copy(scene.materials, &a.materials), copy(scene.material_maps, &a.material_maps), copy(scene.grains, &a.grains);
  copy(scene.glass_maps, &a.glass_maps), copy(scene.iridescences, &a.iridescences);
  copy(scene.diffuse_transmissions, &a.diffuse_transmissions);
  copy(scene.sheens, &a.sheens), copy(scene.clear_coats, &a.clear_coats), copy(scene.tangents, &a.tangents);
  copy(scene.textures, &a.textures), copy(scene.texels, &a.texels);
  copy(scene.lights, &a.lights), copy(scene.cameras, &a.cameras), copy(scene.nodes, &a.nodes);
  copy(scene.animations, &a.animations), copy(scene.channels, &a.channels);
  copy(scene.key_times, &a.key_times), copy(scene.key_values, &a.key_values);
  copy(scene.moving_meshes, &a.moving_meshes);
  copy(scene.rest_positions, &a.rest_positions), copy(scene.rest_normals, &a.rest_normals);
  return a;
}

std::uint32_t count_of(const SceneArrays& a, Invisible what) {
  for (const Reduction& r : a.reductions)
    if (r.what == what) return r.count;
  return 0;
}

// Makes some of the scene's content invisible.
void spoil(SceneArrays* a, Rng* rng) {
  auto chance = [&] { return next_u32(rng) % 2 == 0; };
  a->info.ambient += Vec3{0.1f, 0.1f, 0.1f};  // scenes without any light get the default lights
  const std::uint32_t values[] = {0xFF000000, 0xFFFFFFFF, 0xFFFF8080, 0xFF208040, 0xFFFFFF, next_u32(rng) | 0xFF000000};
  for (const Texture& t : a->textures) {
    const std::uint32_t value = values[next_u32(rng) % 6], count = level_texels(t.width, t.height, t.level_count);
    if (chance()) continue;
    for (std::uint32_t i = 0; i < count; ++i) a->texels[t.texel_begin + i] = value;
  }
  const bool is_white = chance(), is_opaque = chance();
  for (Rgba16& color : a->colors) {
    if (is_opaque) color.a = 65535;
    if (is_white) color = {65535, 65535, 65535, color.a};
  }
  for (Material& m : a->materials) {
    if (m.alpha_mode == AlphaMode::blend && chance()) m.opacity = 1;
    if (m.alpha_mode == AlphaMode::mask && chance()) m.alpha_cutoff = 0.1f;
    if (is_zero(m.emission) && m.diffuse_texture.texture != kNone && chance())
      m.emission = {0.5f, 0.5f, 0.5f}, m.emission_texture = m.diffuse_texture;
  }
  for (MaterialMaps& maps : a->material_maps)
    maps.metallic *= 0.71f, maps.metallic_low *= 0.71f, maps.metallic_high *= 0.71f;
  if (chance()) std::fill(a->key_values.begin(), a->key_values.end(), 0.0f);
  for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::directional}) {
    Light light;
    light.kind = kind, light.position = {0, 90, 0}, light.range = 50;
    if (kind == LightKind::directional || chance()) light.intensity = {0, 0, 0};
    if (chance()) a->lights.push_back(light);
  }
}

// Returns whether a lamp has a texture, without which it may have a closed form.
bool has_textured_lamp(const SceneArrays& a) {
  return std::any_of(a.materials.begin(), a.materials.end(),
                     [](const Material& m) { return m.emission_texture.texture != kNone; });
}

Picture picture_of(const Scene& scene, std::uint32_t features, double seconds, EffectMask without = 0) {
  Settings settings = settings_for(features, 24, 18);
  settings.forced_off = without;
  // Without limits that depend on bounds, or on how many points are opaquely hidden.
  settings.light_tolerance = 0, settings.cut_off_levels = 0, settings.area_shadows = AreaShadows::every;
  return render_picture(scene, settings, seconds);
}

ImportedScene load_text(const std::string& text, bool reduces = true) {
  TemporaryFolder folder;
  ImportOptions options;
  options.reduce = reduces;
  ImportedScene result;
  const Status status = import_scene(folder.write("scene.gltf", text), options, &result);
  CHECK_MESSAGE(status.ok, std::string(status.message));
  return result;
}

std::string reason_of(const Scene& scene, Effect effect) {
  const EffectDecision& d = plan_effects(scene, Settings()).decisions[static_cast<int>(effect)];
  return (d.on ? "on: " : "off: ") + std::string(d.reason);
}

std::string image(const char* uri) {
  return std::string(",\"images\":[{\"uri\":\"") + uri + "\"}],\"textures\":[{\"source\":0}]";
}

}  // namespace

// Goal: leaving out what no picture shows changes no bit of any picture. Method: random scenes with textures of one
// value, opaque masks and blends, still animations and lights that reach nothing, as they are and reduced; every kind
// of reduction occurs.
TEST_CASE("hard_73_reduced_scenes_keep_their_pictures") {
  Rng rng = make_rng(73);
  std::uint32_t counts[kInvisibleCount] = {};
  int wrong = 0;
  std::uint64_t first_wrong = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(effort(700)); ++seed) {
    const std::uint32_t features = next_u32(&rng) & next_u32(&rng) & kAllFeatures;
    SceneArrays arrays = arrays_of(*generate_scene(features, seed));
    spoil(&arrays, &rng);
    const Scene before = view_of(arrays);
    REQUIRE(validate_scene(before).ok);
    const EffectMask without = has_textured_lamp(arrays) ? bit(Effect::area_light) : 0;
    const Picture whole = picture_of(before, features, 0.6, without);
    reduce(&arrays);
    const Scene after = view_of(arrays);
    CHECK_MESSAGE(validate_scene(after).ok, std::string(validate_scene(after).message));
    if (!same_picture(whole, picture_of(after, features, 0.6, without)) && !wrong++) first_wrong = seed;
    for (const Reduction& r : arrays.reductions) counts[static_cast<int>(r.what)] += r.count;
  }
  CAPTURE(first_wrong);
  CHECK(wrong == 0);
  for (int i = 0; i < kInvisibleCount; ++i) {
    CAPTURE(i);
    const auto what = static_cast<Invisible>(i);
    if (effort(700) == 700 && what != Invisible::flat_vertex_normals && what != Invisible::clear_glass)
      CHECK(counts[i] > 0);
  }
}

// Goal: normals along the axis of a face are left out without changing a bit, others stay. Method: boxes with normals
// of any length, lit from all sides; one normal leans, or one corner stands out of its face.
TEST_CASE("hard_73_normals_of_faces_along_axes_are_left_out") {
  Rng rng = make_rng(74);
  for (int round = 0; round < effort(100); ++round)
    for (const bool leans : {false, true}) {
      GeneratedScene s;
      Material m;
      m.brdf = next_u32(&rng) % kBrdfCount, m.exponent = 20, m.roughness = 0.3f, m.specular = {0.3f, 0.3f, 0.3f};
      add_material(&s, m);
      for (int box = 0; box < 3; ++box) {
        const Vec3 low = {next_float(&rng) * 4 - 2, next_float(&rng), next_float(&rng) * 4 - 2};
        add_box(&s, low, low + Vec3{0.5f, 1.3f, 0.7f}, 0);
      }
      s.with_normals = true;
      aim(&s, {2 * next_float(&rng), 2, 5}, {0, 0.5f, 0}, 50);
      s.lights.resize(2);
      for (Light& light : s.lights) light.position = {9 * next_float(&rng) - 4, 4, 5}, light.intensity = {20, 20, 20};
      s.bind();
      SceneArrays arrays = arrays_of(s);
      for (const Triangle& t : s.triangles) {
        const Vec3 &a = s.positions[t.vertex(0)], &b = s.positions[t.vertex(1)], &c = s.positions[t.vertex(2)];
        const Vec3 n = normalize(cross(b - a, c - a));
        for (std::uint32_t v : t.vertices()) arrays.normals[v] = n * (round % 2 ? 1.0f : 0.7f);
      }
      Vec3 aside = {0, 0, 0};
      const int along = arrays.normals[5].x != 0 ? 0 : arrays.normals[5].y != 0 ? 1 : 2;
      aside[(along + 1 + round % 2) % 3] = 0x1p-12f;
      if (leans && round % 4 < 2) arrays.normals[5] += aside;
      if (leans && round % 4 >= 2) arrays.positions[5][along] += 0x1p-12f;
      const Picture whole = picture_of(view_of(arrays), 0, 0);
      reduce(&arrays);
      CHECK(arrays.normals.empty() == !leans);
      CHECK(count_of(arrays, Invisible::flat_vertex_normals) == (leans ? 0 : s.positions.size()));
      CHECK(same_picture(whole, picture_of(view_of(arrays), 0, 0)));
    }
}

// Goal: the normals of inclined faces, as floats in a file have them, are left out; those that lean by more are not,
// nor are those that point to both sides. Method: boxes turned at random; the pictures with and without agree to a
// millionth of the light.
TEST_CASE("hard_73_normals_of_inclined_faces_are_left_out") {
  Rng rng = make_rng(75);
  for (int round = 0; round < effort(60); ++round)
    for (const int change : {0, 1, 2}) {
      CAPTURE(change);
      GeneratedScene s;
      Material m;
      m.brdf = next_u32(&rng) % kBrdfCount, m.exponent = 20, m.roughness = 0.3f, m.specular = {0.3f, 0.3f, 0.3f};
      add_material(&s, m);
      add_box(&s, {-0.5f, -0.4f, -0.6f}, {0.7f, 0.8f, 0.5f}, 0);
      Quaternion turn = {next_float(&rng), next_float(&rng), next_float(&rng), 0.3f};
      const float norm = std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w);
      turn = {turn.x / norm, turn.y / norm, turn.z / norm, turn.w / norm};
      const Transform place = compose({0.1f, 0.2f, -0.3f}, turn, {1, 1, 1});
      for (Vec3& p : s.positions) p = transform_point(place, p);
      s.with_normals = true;
      aim(&s, {1, 2, 4}, {0, 0, 0}, 40);
      s.lights.resize(1);
      s.lights[0].position = {3, 4, 5}, s.lights[0].intensity = {20, 20, 20};
      s.bind();
      SceneArrays arrays = arrays_of(s);
      for (const Triangle& t : s.triangles) {
        const Vec3 &a = s.positions[t.vertex(0)], &b = s.positions[t.vertex(1)], &c = s.positions[t.vertex(2)];
        for (std::uint32_t v : t.vertices()) arrays.normals[v] = normalize(cross(b - a, c - a));
      }
      if (change == 1) arrays.normals[5] = normalize(arrays.normals[5] + Vec3{0x1p-16f, -0x1p-16f, 0x1p-17f});
      if (change == 2) arrays.normals[6] = -arrays.normals[6];
      const Picture whole = picture_of(view_of(arrays), 0, 0);
      reduce(&arrays);
      CHECK(arrays.normals.empty() == (change == 0));
      CHECK(count_of(arrays, Invisible::flat_vertex_normals) == (change == 0 ? s.positions.size() : 0));
      const Picture after = picture_of(view_of(arrays), 0, 0);
      float most = 0;
      for (std::size_t p = 0; p < whole.size(); ++p) most = std::max(most, max_component(abs(whole[p] - after[p])));
      CHECK(most < 1e-5f);
    }
}

// Goal: what is left out of a model is not in its scene, and the plan says why. Method: files with each kind, imported
// with and without the reduction, and baked.
TEST_CASE("reduction_is_said_by_the_plan") {
  const struct {
    std::string text;
    Effect effect;
    const char* reason;
  } rows[] = {
      {triangle_gltf("{\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0}}", image(kBlackPng)),
       Effect::emission, "off: none of 1 materials emit (1 with a black texture)"},
      {triangle_gltf("{\"alphaMode\":\"BLEND\"}"), Effect::alpha_blend,
       "off: none of 1 materials blend with the background (1 with alpha 1)"},
      {triangle_gltf("{\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}",
                     image(kGreyPng)),
       Effect::alpha_mask, "off: none of 1 materials have holes (1 with alpha above its cut-off)"},
      {triangle_gltf("{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}", image(kGreyPng)),
       Effect::texture, "off: none of 1 materials have a texture (1 with a uniform one)"},
      {triangle_gltf("{\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":{\"index\":0}}}", image(kGreyPng)),
       Effect::metallic_roughness,
       "off: none of 1 materials have a metallic-roughness or specular texture (1 with a uniform one)"},
      {triangle_gltf("{\"normalTexture\":{\"index\":0}}", image(kGreyPng)), Effect::normal_map,
       "off: none of 1 materials have a normal texture (1 with a flat one)"},
  };
  for (const auto& row : rows) {
    const ImportedScene imported = load_text(row.text);
    CHECK(reason_of(imported.scene, row.effect) == row.reason);
    CHECK(imported.scene.textures.count == 0);
    CHECK(imported.scene.texels.count == 0);
    const ImportedScene whole = load_text(row.text, false);
    CHECK(whole.scene.reductions.count == 0);
    std::vector<std::uint8_t> block(baked_size(imported.scene) + 64);
    auto* bytes = reinterpret_cast<std::uint8_t*>((reinterpret_cast<std::uintptr_t>(block.data()) + 63) / 64 * 64);
    baked_write(imported.scene, bytes);
    Scene opened;
    REQUIRE(baked_open(bytes, baked_size(imported.scene), &opened).ok);
    CHECK(reason_of(opened, row.effect) == row.reason);
  }
}

// Goal: glass that light passes as if it were not there is left out; glass that bends, reflects or takes any is not,
// nor is glass in a scene with another body, which may contain it. Method: a box of it in front of a room, and one
// change at a time; the pictures with and without agree to the rounding of rays that begin anew.
TEST_CASE("hard_73_glass_that_does_nothing_is_left_out") {
  const std::function<void(Material*)> changes[] = {
      [](Material*) {},
      [](Material* m) {
        m->thin = 1, m->absorption = {1, 1, 1};
      },
      [](Material* m) { m->ior = 0x1.000002p0f; },
      [](Material* m) { m->transmission.y = 0x1.fffffep-1f; },
      [](Material* m) {
        m->absorption = {0, 0, 0x1p-20f};
      },
      [](Material* m) { m->diffuse.x = 0x1p-20f; },
      [](Material* m) { m->specular.x = 0x1p-20f; },
      [](Material* m) { m->mirror.x = 0x1p-20f; },
      [](Material* m) { m->emission.x = 0x1p-20f; },
      [](Material* m) { m->alpha_mode = AlphaMode::blend, m->opacity = 0.5f; },
  };
  for (std::size_t i = 0; i < std::size(changes); ++i)
    for (const bool has_body : {false, true}) {
      CAPTURE(i);
      CAPTURE(has_body);
      GeneratedScene s;
      Material clear, body;
      clear.diffuse = {0, 0, 0}, clear.transmission = {1, 1, 1}, clear.ior = 1;
      body = clear, body.ior = 1.5f;
      changes[i](&clear);
      add_material(&s, Material()), add_material(&s, clear);
      if (has_body) add_material(&s, body);
      add_box(&s, {-3, 0, -3}, {3, 3, 3}, 0, true);
      add_box(&s, {-0.5f, 0.5f, 0}, {0.4f, 1.4f, 0.8f}, 1);
      aim(&s, {0.3f, 1.2f, 2.8f}, {0, 1, 0}, 50);
      s.lights.resize(1);
      s.lights[0].position = {1, 2.5f, 1.5f}, s.lights[0].intensity = {5, 5, 5};
      s.bind();
      SceneArrays arrays = arrays_of(s);
      const Picture whole = picture_of(view_of(arrays), 0, 0);
      reduce(&arrays);
      const bool is_left_out = i < 2 && !has_body;
      CHECK(arrays.triangles.size() == (is_left_out ? 12 : 24));
      CHECK(count_of(arrays, Invisible::clear_glass) == is_left_out);
      CHECK(reason_of(view_of(arrays), Effect::refraction) ==
            (is_left_out ? "off: none of 1 materials transmit (1 with index 1 and no tint)"
                         : "on: 1 of 2 materials transmit"));
      if (!is_left_out) continue;
      const Picture without = picture_of(view_of(arrays), 0, 0);
      float most = 0;
      for (std::size_t p = 0; p < whole.size(); ++p)
        most = std::max(most, max_component(abs(whole[p] - without[p])) / max_component(whole[p]));
      CHECK(most < 1e-4f);
    }
  GeneratedScene alone;
  Material clear;
  clear.diffuse = {0, 0, 0}, clear.transmission = {1, 1, 1}, clear.ior = 1;
  add_material(&alone, clear);
  add_box(&alone, {0, 0, 0}, {1, 1, 1}, 0);
  alone.bind();
  SceneArrays arrays = arrays_of(alone);
  reduce(&arrays);
  CHECK(arrays.triangles.size() == 12);
}

// Goal: textures of one value become factors, whichever the slot; one odd texel keeps them. Method: a box whose
// material uses them all, in turn.
TEST_CASE("hard_73_textures_of_one_value_are_factors") {
  enum {
    kEmission,
    kSpecular,
    kSpecularColor,
    kCoatStrength,
    kCoatRoughness,
    kGrain,
    kSheenColor,
    kSheenRoughness,
    kSlotCount
  };
  for (int slot = 0; slot < kSlotCount; ++slot)
    for (const bool is_even : {true, false}) {
      CAPTURE(slot);
      CAPTURE(is_even);
      GeneratedScene s;
      const std::array<int, 4> texel = {{90, 160, 200, 130}};
      std::vector<std::array<int, 4>> texels(16, texel);
      if (!is_even) texels[9] = {{91, 161, 201, 131}};
      TextureUse use;
      use.texture = add_texture(&s, 4, 4, texels);
      s.materials.resize(1), s.materials[0].brdf = kGgx;
      s.material_maps.resize(1), s.clear_coats.resize(1), s.grains.resize(1), s.sheens.resize(1);
      MaterialMaps& maps = s.material_maps[0];
      ClearCoat& coat = s.clear_coats[0];
      maps.model = {{0.6f, 0.5f, 0.4f}, {0.3f, 0.25f, 0.2f}, 0.8f};
      maps.metallic = maps.metallic_low = maps.metallic_high = 0.3f;
      maps.roughness = maps.roughness_low = maps.roughness_high = 0.5f;
      set_lobes(maps.model, 0.3f, 0.5f, 0, &s.materials[0]);
      if (slot == kEmission) s.materials[0].emission = {0.3f, 0.2f, 0.1f}, s.materials[0].emission_texture = use;
      if (slot == kSpecular) maps.specular = use;
      if (slot == kSpecularColor) maps.specular_color = use;
      if (slot >= kCoatStrength && slot <= kCoatRoughness)
        coat.strength = 0.9f, coat.roughness = coat.roughness_low = 0.6f;
      if (slot == kCoatStrength) coat.strength_texture = use;
      if (slot == kCoatRoughness) coat.roughness_texture = use, coat.roughness_low = 0.6f * (160 / 255.0f);
      if (slot == kGrain) s.grains[0].direction = {0.7f, 0.2f}, s.grains[0].texture = use;
      if (slot >= kSheenColor) s.sheens[0].color = {0.9f, 0.6f, 0.5f};
      if (slot >= kSheenColor) s.sheens[0].roughness = s.sheens[0].roughness_low = 0.6f;
      if (slot == kSheenColor) s.sheens[0].color_texture = use;
      if (slot == kSheenRoughness)
        s.sheens[0].roughness_texture = use, s.sheens[0].roughness_low = 0.6f * (130 / 255.0f);
      s.with_uvs = true;
      add_quad(&s, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, 0);
      add_box(&s, {-1, 0, -1}, {1, 1, 1}, 0);
      for (std::size_t v = 0; v < s.uvs.size(); ++v) s.uvs[v] = {0.37f * static_cast<float>(v % 7), 0.2f * (v % 3)};
      aim(&s, {2, 2, 4}, {0, 0.5f, 0}, 50);
      s.lights.resize(1);
      s.lights[0].position = {1, 3, 3}, s.lights[0].intensity = {9, 9, 9};
      s.scene.info.ambient = {0.2f, 0.2f, 0.2f};
      s.bind();
      SceneArrays arrays = arrays_of(s);
      REQUIRE(validate_scene(view_of(arrays)).ok);
      const Picture whole = picture_of(view_of(arrays), 0, 0, bit(Effect::area_light));
      reduce(&arrays);
      CHECK(validate_scene(view_of(arrays)).ok);
      CHECK(arrays.textures.empty() == is_even);
      CHECK(same_picture(whole, picture_of(view_of(arrays), 0, 0, bit(Effect::area_light))));
    }
}

// Goal: an animation that holds its nodes at rest is none; it plays where a key differs. Method: a translation that is
// that of the node, or almost; the mesh then stands where the node puts it.
TEST_CASE("reduction_leaves_out_still_animations") {
  for (const bool moves : {false, true}) {
    GltfWriter w;
    w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
    w.floats({0, 1}), w.vec3s({2, 3, 4, 2, moves ? 3.001f : 3, 4});
    const ImportedScene imported = load_text(
        w.gltf("\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":[2,3,4]}],"
               "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"animations\":[{\"channels\":[{"
               "\"sampler\":0,"
               "\"target\":{\"node\":0,\"path\":\"translation\"}}],\"samplers\":[{\"input\":1,\"output\":2}]}]"));
    CHECK(is_animated(imported.scene) == moves);
    CHECK(imported.scene.nodes.count == (moves ? 1 : 0));
    CHECK(bounds(imported.scene).low == Vec3{2, 3, 4});
    CHECK(reason_of(imported.scene, Effect::animation) ==
          (moves ? "on: 1 animation" : "off: nothing moves (1 animation holds still)"));
  }
}

// Goal: values that channels change are not folded, nor is the last light dropped, nor alpha with white colours.
// Method: a material whose colour and emission are animated; a single light out of range; a blend by vertices.
TEST_CASE("reduction_keeps_what_may_change") {
  GeneratedScene s;
  Material m;
  m.emission = {1, 1, 1};
  m.diffuse_texture.texture = m.emission_texture.texture = add_texture(&s, 1, 1, {{{9, 9, 9, 255}}});
  add_material(&s, m);
  add_quad(&s, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 0);
  s.with_uvs = true;
  s.lights.resize(1);
  s.lights[0].position = {0, 9, 0}, s.lights[0].range = 1;
  s.bind();
  SceneArrays arrays = arrays_of(s);
  Channel channel = {};
  channel.key_count = 1, channel.path = ChannelPath::material_diffuse;
  arrays.channels.push_back(channel);
  arrays.animations.push_back({0, 1, 1});
  arrays.key_times = {0}, arrays.key_values = {0.1f, 0.2f, 0.3f};
  SceneArrays free = arrays_of(s);
  arrays.colors.assign(4, {65535, 65535, 65535, 9}), free.colors = arrays.colors;
  arrays.materials[0].alpha_mode = AlphaMode::blend;
  reduce(&arrays), reduce(&free);
  CHECK(arrays.materials[0].diffuse_texture.texture == 0);
  CHECK(free.materials[0].diffuse_texture.texture == kNone);
  CHECK(arrays.colors.size() == 4);
  CHECK(free.colors.empty());
  CHECK(count_of(free, Invisible::white_vertex_colors) == 4);
  CHECK(arrays.lights.size() == 1);
  CHECK(free.lights.size() == 1);
}
