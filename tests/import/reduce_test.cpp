// Import leaves out contents that no picture shows.
#include <algorithm>

#include "brdf/brdf_list.h"
#include "desktop/import/reduce.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "plan/plan_effects.h"
#include "scene/baked.h"
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
  copy(scene.clear_coats, &a.clear_coats), copy(scene.tangents, &a.tangents), copy(scene.textures, &a.textures);
  copy(scene.texels, &a.texels), copy(scene.lights, &a.lights), copy(scene.cameras, &a.cameras);
  copy(scene.nodes, &a.nodes), copy(scene.animations, &a.animations), copy(scene.channels, &a.channels);
  copy(scene.key_times, &a.key_times), copy(scene.key_values, &a.key_values);
  copy(scene.moving_meshes, &a.moving_meshes), copy(scene.rest_positions, &a.rest_positions);
  copy(scene.rest_normals, &a.rest_normals);
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
  const std::uint32_t values[] = {0xFF000000, 0xFFFFFFFF, 0xFFFF8080, 0xFF208040, next_u32(rng) | 0xFF000000};
  for (const Texture& t : a->textures) {
    const std::uint32_t value = values[next_u32(rng) % 5], count = level_texels(t.width, t.height, t.level_count);
    if (chance()) continue;
    for (std::uint32_t i = 0; i < count; ++i) a->texels[t.texel_begin + i] = value;
  }
  for (Rgba16& color : a->colors)
    if (a->colors[0].g & 1) color.a = 65535;
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

Picture picture_of(const Scene& scene, std::uint32_t features, double seconds) {
  Settings settings = settings_for(features, 24, 18);
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
    const Picture whole = picture_of(before, features, 0.6);
    reduce(&arrays);
    const Scene after = view_of(arrays);
    CHECK_MESSAGE(validate_scene(after).ok, std::string(validate_scene(after).message));
    if (!same_picture(whole, picture_of(after, features, 0.6)) && !wrong++) first_wrong = seed;
    for (const Reduction& r : arrays.reductions) counts[static_cast<int>(r.what)] += r.count;
  }
  CAPTURE(first_wrong);
  CHECK(wrong == 0);
  for (int i = 0; i < kInvisibleCount; ++i) {
    CAPTURE(i);
    if (effort(700) == 700 && i != static_cast<int>(Invisible::flat_vertex_normals)) CHECK(counts[i] > 0);
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

// Goal: values that channels change are not folded, nor is the last light dropped. Method: a material whose colour and
// emission are animated; a single light out of range.
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
  reduce(&arrays), reduce(&free);
  CHECK(arrays.materials[0].diffuse_texture.texture == 0);
  CHECK(free.materials[0].diffuse_texture.texture == kNone);
  CHECK(arrays.lights.size() == 1);
  CHECK(free.lights.size() == 1);
}
