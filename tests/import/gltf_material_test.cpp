// Materials and textures of glTF.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "brdf/brdf_list.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "scene/baked.h"
#include "scene/texture_levels.h"
#include "scene/texture_side.h"

using namespace pocketray;

namespace {

// 2 × 2 texels: red, green / half-transparent blue, transparent white.
const char* const kColors =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFUlEQVR42mP4z8DwHwyBdMP///8ZAEZOCHkCeX4dAAAAAElFTkSuQmCC";
// 2 × 2 texels of (0, 128, 64): roughness 128/255, metallic 64/255.
const char* const kRoughMetal =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAEElEQVR42mNgaHD4D8YwBgA5dAb9ejoCwQAAAABJRU5ErkJggg==";

ImportedScene load_text(const std::string& text, const ImportOptions& options = ImportOptions()) {
  TemporaryFolder folder;
  return load(folder.write("scene.gltf", text), options);
}
Material material_of(const std::string& json, const std::string& rest = "") {
  ImportedScene imported = load_text(triangle_gltf(json, rest));
  REQUIRE(imported.scene.materials.count == 1);
  return imported.scene.materials[0];
}
std::string images(const std::string& uri, const std::string& textures = "{\"source\":0}",
                   const std::string& samplers = "") {
  return ",\"images\":[{\"uri\":\"" + uri + "\"}],\"textures\":[" + textures + "]" +
         (samplers.empty() ? "" : ",\"samplers\":[" + samplers + "]");
}
void check_vec(const Vec3& a, const Vec3& b) {
  for (int c = 0; c < 3; ++c) CHECK(a[c] == doctest::Approx(b[c]).epsilon(1e-5));
}

}  // namespace

// Goal: the metallic-roughness mapping as stated in gltf_material.cpp. Method: its formulas by hand at three points.
TEST_CASE("gltf_metallic_roughness_maps_to_our_lobes") {
  Material plastic = material_of(
      "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,1],\"metallicFactor\":0,\"roughnessFactor\":0.5}}");
  check_vec(plastic.diffuse, {0.8f, 0.4f, 0.2f});
  check_vec(plastic.specular, {0.04f, 0.04f, 0.04f});
  check_vec(plastic.mirror, {0, 0, 0});
  check_vec(plastic.specular_tinted, {0, 0, 0});
  CHECK(plastic.brdf == kGgx);
  CHECK(plastic.roughness == 0.25f);
  CHECK(plastic.grazing == 1);
  CHECK(plastic.double_sided == 0);
  Material gold = material_of(
      "{\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.8,0.4,1],\"metallicFactor\":1,"
      "\"roughnessFactor\":0.15}}");
  check_vec(gold.diffuse, {0, 0, 0});
  check_vec(gold.mirror, {0.25f, 0.2f, 0.1f});
  check_vec(gold.specular, {0.75f, 0.6f, 0.3f});
  check_vec(gold.mirror_tinted, gold.mirror);
  check_vec(gold.specular_tinted, gold.specular);
  CHECK(gold.grazing == doctest::Approx(0.75));
  CHECK(gold.double_sided == 1);
  Material mirror = material_of("{\"pbrMetallicRoughness\":{\"roughnessFactor\":0}}");
  check_vec(mirror.mirror, {1, 1, 1});
  check_vec(mirror.specular, {0, 0, 0});
  CHECK(mirror.roughness == 0);
}

// Goal: KHR_materials_specular scales what a dielectric reflects, not what a metal does. Method: its formulas by hand:
// F₀ = min(.04 colour, 1) factor, F₉₀ = factor, mixed with the metal's.
TEST_CASE("gltf_specular_factor_and_color_scale_the_dielectric_part") {
  const std::string specular =
      "\"extensions\":{\"KHR_materials_specular\":{\"specularFactor\":0.5,\"specularColorFactor\":[1,0.5,40]}}}";
  Material plastic = material_of("{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":1}," + specular);
  check_vec(plastic.specular, {0.02f, 0.01f, 0.5f});
  CHECK(plastic.grazing == 0.5f);
  Material half = material_of("{\"pbrMetallicRoughness\":{\"metallicFactor\":0.5,\"roughnessFactor\":1}," + specular);
  check_vec(half.specular, {0.51f, 0.505f, 0.75f});
  check_vec(half.specular_tinted, {0.5f, 0.5f, 0.5f});
  CHECK(half.grazing == 0.75f);
  CHECK(material_of("{\"pbrMetallicRoughness\":{\"roughnessFactor\":1}," + specular).grazing == 1);
}

// Goal: transmission, index of refraction and volume. Method: Beer–Lambert over the attenuation distance gives back the
// attenuation colour; without a volume the surface is thin.
TEST_CASE("gltf_transmission_ior_and_volume_become_glass") {
  const std::string glass =
      "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.9,0.9,1,1],\"metallicFactor\":0,\"roughnessFactor\":0},"
      "\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.75},\"KHR_materials_ior\":{\"ior\":1."
      "8}";
  Material thick = material_of(glass +
                               ",\"KHR_materials_volume\":{\"thicknessFactor\":1,\"attenuationDistance\":2,"
                               "\"attenuationColor\":[0.25,0.5,1]}}}");
  check_vec(thick.transmission, {0.675f, 0.675f, 0.75f});
  check_vec(thick.diffuse, {0.225f, 0.225f, 0.25f});
  CHECK(thick.ior == 1.8f);
  CHECK(thick.thin == 0);
  for (int c = 0; c < 3; ++c) {
    const float kept[] = {0.25f, 0.5f, 1};
    CHECK(std::exp(-2.0 * static_cast<double>(thick.absorption[c])) == doctest::Approx(kept[c]).epsilon(1e-5));
  }
  float f0 = 0.8f / 2.8f;
  check_vec(thick.mirror, Vec3{1, 1, 1} * (f0 * f0 * 0.25f));
  CHECK(material_of(glass + "}}").thin == 1);
}

// Goal: emission with its strength, unlit surfaces, alpha modes.
TEST_CASE("gltf_emission_unlit_and_alpha_modes") {
  Material lamp = material_of(
      "{\"emissiveFactor\":[1,0.5,0.25],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8}}"
      "}");
  check_vec(lamp.emission, {8, 4, 2});
  Material sign = material_of(
      "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.1,0.2,0.3,0.5]},\"alphaMode\":\"BLEND\",\"emissiveFactor\":[1,"
      "1,1],"
      "\"extensions\":{\"KHR_materials_unlit\":{}}}");
  CHECK(sign.unlit == 1);
  check_vec(sign.diffuse, {0.1f, 0.2f, 0.3f});
  check_vec(sign.emission, {0, 0, 0});
  CHECK(sign.opacity == 0.5f);
  CHECK(sign.alpha_mode == AlphaMode::blend);
  Material leaf = material_of("{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25}");
  CHECK(leaf.alpha_mode == AlphaMode::mask);
  CHECK(leaf.alpha_cutoff == 0.25f);
}

// Goal: textures with sampler, transform and texture-coordinate set; texels as the PNG has them; textures of one image
// share its texels.
TEST_CASE("gltf_textures_keep_texels_sampler_transform_and_uv_set") {
  std::string info =
      "{\"index\":1,\"texCoord\":0,\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.5,0.25],\"scale\":[2,3],"
      "\"rotation\":1.5707963267948966,\"texCoord\":1}}}";
  ImportedScene imported = load_text(triangle_gltf("{\"pbrMetallicRoughness\":{\"baseColorTexture\":" + info +
                                                       "},\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0,"
                                                       "\"texCoord\":1}}",
                                                   images(kColors, "{\"source\":0},{\"source\":0,\"sampler\":0}",
                                                          "{\"magFilter\":9728,\"wrapS\":33071,\"wrapT\":33648}")));
  const Scene& s = imported.scene;
  REQUIRE(s.textures.count == 2);
  CHECK(s.texels.count == 4 + 1);  // and the level of one texel
  const std::uint8_t expected[16] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 128, 255, 255, 255, 0};
  CHECK(std::memcmp(s.texels.data, expected, 16) == 0);
  const Material& m = s.materials[0];
  const Texture& base = s.textures[m.diffuse_texture.texture];
  CHECK(base.nearest == 1);
  CHECK(base.wrap_u == Wrap::clamp);
  CHECK(base.wrap_v == Wrap::mirror);
  CHECK(s.textures[m.emission_texture.texture].nearest == 0);
  CHECK(s.uvs[1].x == 0.75f);  // TEXCOORD_1, as the transform says
  // uv' = T·R·S·uv of the extension: R turns (1, 0) into (0, −1).
  const float(*t)[3] = m.diffuse_texture.m;
  const float u = t[0][0] * 1 + t[0][1] * 0 + t[0][2], v = t[1][0] * 1 + t[1][1] * 0 + t[1][2];
  CHECK(u == doctest::Approx(0.5));
  CHECK(v == doctest::Approx(0.25 - 2));
}

// Goal: a sampler that names a filter without mip maps gets no levels, any other does, and so does a texture without
// one; options can leave them out. Method: each value of minFilter, and none.
TEST_CASE("gltf_samplers_choose_mip_maps") {
  const char* material = "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}";
  auto level_count = [&](const std::string& sampler, const ImportOptions& options = ImportOptions()) {
    const ImportedScene imported = load_text(
        triangle_gltf(material, images(kColors, "{\"source\":0,\"sampler\":0}", "{" + sampler + "}")), options);
    REQUIRE(imported.scene.textures.count == 1);
    CHECK(imported.scene.texels.count == (imported.scene.textures[0].level_count == 2 ? 5 : 4));
    return static_cast<int>(imported.scene.textures[0].level_count);
  };
  for (const char* none : {"9728", "9729"}) CHECK(level_count(std::string("\"minFilter\":") + none) == 1);
  for (const char* mip : {"9984", "9985", "9986", "9987"}) CHECK(level_count(std::string("\"minFilter\":") + mip) == 2);
  CHECK(level_count("") == 2);
  ImportOptions options;
  options.mip_maps = false;
  CHECK(level_count("", options) == 1);
}

// Goal: a metallic-roughness texture becomes a map of numbers, with factors and ranges; the material has the lobes of
// its mean. Method: a texture of one colour, once plain, once in a transparent material, which keeps the mean alone,
// and says so.
TEST_CASE("gltf_metallic_roughness_texture_becomes_a_map") {
  const std::string textured =
      "{\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":{\"index\":0,\"texCoord\":1},"
      "\"metallicFactor\":0.5,\"baseColorFactor\":[0.5,0.25,1,1]}";
  ImportedScene imported =
      load_text(triangle_gltf(textured + ",\"normalTexture\":{\"index\":0,\"scale\":-2},\"occlusionTexture\":{"
                                         "\"index\":0,\"texCoord\":1,\"strength\":0.5}}",
                              images(kRoughMetal)));
  const double metallic = 32 / 255.0, roughness = 128 / 255.0;
  const Scene& s = imported.scene;
  CHECK(s.materials[0].diffuse.x == doctest::Approx(0.5 * (1 - metallic)));
  CHECK(s.materials[0].roughness == doctest::Approx(roughness * roughness));
  REQUIRE(s.material_maps.count == 1);
  REQUIRE(s.textures.count == 2);
  CHECK(s.textures[0].texel_begin == s.textures[1].texel_begin);
  const MaterialMaps& maps = s.material_maps[0];
  CHECK((maps.metallic_roughness.texture == 0 && s.textures[0].uv_set == 1));
  CHECK(maps.model.base == Vec3{0.5f, 0.25f, 1});
  check_vec(maps.model.dielectric, {0.04f, 0.04f, 0.04f});
  CHECK(maps.model.grazing == 1);
  CHECK((maps.metallic == 0.5f && maps.roughness == 1));
  CHECK((maps.metallic_low == maps.metallic_high && maps.roughness_low == maps.roughness_high));
  CHECK(maps.metallic_low == doctest::Approx(metallic));
  CHECK(maps.roughness_low == doctest::Approx(roughness));
  CHECK((s.uvs[1].x == 1 && s.second_uvs[1].x == 0.75f));
  CHECK((maps.normal.texture == 1 && maps.normal_scale == -2 && s.textures[1].uv_set == 0));
  CHECK((maps.occlusion.texture == 0 && maps.occlusion_strength == 0.5f));  // the same texture, in the scene once
  CHECK(imported.warning.empty());
  imported = load_text(
      triangle_gltf(textured + ",\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.5}}}",
                    images(kRoughMetal)));
  REQUIRE(imported.scene.glass_maps.count == 1);
  CHECK(imported.scene.glass_maps[0].transmission == 0.5f);
  CHECK(imported.scene.material_maps[0].metallic_roughness.texture != kNone);
  CHECK(imported.scene.materials[0].diffuse.x == doctest::Approx(0.25 * (1 - metallic)));
  CHECK(imported.scene.materials[0].transmission.x == doctest::Approx(0.25 * (1 - metallic)));
  CHECK_FALSE(contains(imported.warning, "mean"));
}

// Goal: maps of an unlit material, which would have no effect, take no memory. Method: none becomes a texture.
TEST_CASE("gltf_unlit_materials_have_no_maps") {
  ImportedScene imported = load_text(triangle_gltf(
      "{\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":{\"index\":0}},\"normalTexture\":{\"index\":0},"
      "\"occlusionTexture\":{\"index\":0},\"extensions\":{\"KHR_materials_unlit\":{}}}",
      images(kRoughMetal)));
  CHECK(imported.scene.materials[0].unlit == 1);
  CHECK(imported.scene.material_maps.count == 0);
  CHECK(imported.scene.textures.count == 0);
  CHECK(imported.scene.texels.count == 0);
}

// Goal: specular textures become maps; the material has the lobes of their means. Method: four texels, of which the
// green channels are 0, 1, 0, 1 and the alphas 1, 1, ½, 0.
TEST_CASE("gltf_specular_textures_become_maps") {
  const std::string rest =
      "\"extensions\":{\"KHR_materials_specular\":{\"specularFactor\":0.5,\"specularTexture\":{\"index\":0},"
      "\"specularColorTexture\":{\"index\":0}}}}";
  const std::string pbr = "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0.75},";
  ImportedScene imported = load_text(triangle_gltf(pbr + rest, images(kColors)));
  const Scene& s = imported.scene;
  REQUIRE(s.material_maps.count == 1);
  const MaterialMaps& maps = s.material_maps[0];
  CHECK((maps.specular.texture == 0 && maps.specular_color.texture == 0 && maps.metallic_roughness.texture == kNone));
  CHECK((maps.metallic_low == 0 && maps.metallic_high == 0));
  CHECK((maps.roughness_low == 0.75f && maps.roughness_high == 0.75f));
  check_vec(maps.model.dielectric, {0.02f, 0.02f, 0.02f});
  CHECK(maps.model.grazing == 0.5f);
  const double alpha = static_cast<double>(s.materials[0].grazing) / 0.5;
  CHECK((alpha > 0.6 && alpha < 0.65));
  CHECK(static_cast<double>(s.materials[0].specular.y) == doctest::Approx(0.02 * alpha / 2).epsilon(1e-4));
  CHECK(imported.warning.find("specular") == std::string::npos);
}

// Goal: KHR_materials_pbrSpecularGlossiness becomes the same lobes. Method: its formulas by hand: what the specular
// colour leaves is diffuse; glossiness 0.5 is roughness 0.5; a texture's colours are a map, its alphas (1, 1, ½, 0)
// their mean.
TEST_CASE("gltf_specular_glossiness_is_translated") {
  const std::string start =
      "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1],\"roughnessFactor\":0.1},\"extensions\":{"
      "\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.8,0.4,0.2,0.5],\"specularFactor\":[0.25,0.5,0.125]"
      ",";
  const Material m = material_of(start + "\"glossinessFactor\":0.5}},\"alphaMode\":\"BLEND\"}");
  check_vec(m.diffuse, {0.4f, 0.2f, 0.1f});
  check_vec(m.specular, {0.25f, 0.5f, 0.125f});
  CHECK(m.roughness == 0.25f);
  CHECK(m.grazing == 1);
  CHECK(m.opacity == 0.5f);
  const ImportedScene imported =
      load_text(triangle_gltf(start + "\"specularGlossinessTexture\":{\"index\":0,\"extensions\":{"
                                      "\"KHR_texture_transform\":{\"scale\":[3,2]}}}}}}",
                              images(kColors)));
  REQUIRE(imported.scene.material_maps.count == 1);
  const MaterialMaps& maps = imported.scene.material_maps[0];
  CHECK((maps.specular_color.texture == 0 && maps.specular.texture == kNone));
  CHECK((maps.specular_color.m[0][0] == 3 && maps.specular_color.m[1][1] == 2));
  check_vec(maps.model.dielectric, {0.25f, 0.5f, 0.125f});
  CHECK(maps.roughness_low == doctest::Approx(1 - (1 + 1 + 128 / 255.0 + 0) / 4).epsilon(1e-3));
  CHECK(imported.warning.find("glossiness textures") != std::string::npos);
  // With the usual factor of 1, what the texture's mean leaves is diffuse: its channels are 1 in half of the texels.
  const Material usual = material_of(
      "{\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"specularGlossinessTexture\":{\"index\":0}}}}",
      images(kColors));
  check_vec(usual.diffuse, {0.5f, 0.5f, 0.5f});
}

// Goal: KHR_materials_anisotropy becomes a grain: its strength, turned by its rotation, and its texture; metals without
// it have none. Method: a rotation of 60° and more than a turn.
TEST_CASE("gltf_anisotropy_becomes_a_grain") {
  const std::string brushed =
      "{\"pbrMetallicRoughness\":{\"roughnessFactor\":0.5},\"extensions\":{\"KHR_materials_anisotropy\":{"
      "\"anisotropyStrength\":0.8,\"anisotropyRotation\":7.330383";
  ImportedScene imported = load_text(triangle_gltf(brushed + "}}}"));
  REQUIRE(imported.scene.grains.count == 1);
  CHECK(imported.scene.grains[0].direction.x == doctest::Approx(0.4).epsilon(1e-5));
  CHECK(imported.scene.grains[0].direction.y == doctest::Approx(0.8 * 0.8660254).epsilon(1e-5));
  CHECK(imported.scene.grains[0].texture.texture == kNone);
  CHECK(imported.scene.uvs.count == imported.scene.positions.count);
  CHECK(imported.warning.find("anisotropy") == std::string::npos);
  imported = load_text(triangle_gltf(brushed + ",\"anisotropyTexture\":{\"index\":0}}}}", images(kRoughMetal)));
  REQUIRE(imported.scene.grains.count == 1);
  CHECK(imported.scene.grains[0].texture.texture == 0);
  CHECK(imported.scene.uvs.count > 0);
  CHECK(load_text(triangle_gltf("{}")).scene.grains.count == 0);
  const std::string off = "{\"extensions\":{\"KHR_materials_anisotropy\":{\"anisotropyTexture\":{\"index\":0}}}}";
  imported = load_text(triangle_gltf(off, images(kRoughMetal)));
  CHECK((imported.scene.grains.count == 0 && imported.scene.textures.count == 0));
}

// Goal: a required extension that only changes looks is named, not refused; others are (hostile_test.cpp).
TEST_CASE("gltf_required_looks_are_a_warning") {
  const ImportedScene imported = load_text(triangle_gltf("{}",
                                                         ",\"extensionsUsed\":[\"KHR_materials_dispersion\"],"
                                                         "\"extensionsRequired\":[\"KHR_materials_dispersion\"]"));
  CHECK(imported.warning.find("KHR_materials_dispersion") != std::string::npos);
}

// Goal: a texture whose image only an extension knows is left out and named, wherever a material uses it. Method: such
// a texture as colour, normals and a coat's strength, beside one with an image.
TEST_CASE("gltf_textures_in_unknown_formats_are_left_out") {
  const std::string textures =
      images(kColors, "{\"extensions\":{\"KHR_texture_basisu\":{\"source\":0}}},{\"source\":0}");
  const std::string names = "[\"KHR_texture_basisu\"]",
                    extensions = ",\"extensionsUsed\":" + names + ",\"extensionsRequired\":" + names;
  auto material = [&](int texture) {
    const std::string use = "{\"index\":" + std::to_string(texture) + "}";
    return load_text(triangle_gltf("{\"pbrMetallicRoughness\":{\"baseColorTexture\":" + use + "},\"normalTexture\":" +
                                       use + ",\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5," +
                                       "\"clearcoatTexture\":" + use + "}}}",
                                   extensions + textures));
  };
  const ImportedScene without = material(0), with = material(1);
  CHECK(without.warning.find("textures in formats other than PNG, JPEG and WebP") != std::string::npos);
  CHECK(without.scene.textures.count == 0);
  REQUIRE(without.scene.clear_coats.count > 0);
  CHECK(without.scene.clear_coats[0].strength == 0.5f);
  CHECK(with.warning.find("formats other than") == std::string::npos);
  CHECK(with.scene.textures.count > 0);
}

// Goal: a model read with small textures is what a device makes of it by leaving out levels. Method: the sample helmet
// at a side of at most 64 and as usual; all arrays but the textures are equal, and so are the levels.
TEST_CASE("gltf_textures_lack_larger_levels") {
  std::string path = shared_scene("gltf/DamagedHelmet.glb");
  if (!have(path)) return;
  ImportOptions options;
  options.texture_side_max = 64;
  ImportedScene imported = load(path, options);
  REQUIRE(imported.scene.textures.count == 5);
  for (const Texture& t : imported.scene.textures) CHECK((t.width == 64 && t.height == 64));
  const ImportedScene usual = load(path);
  for (std::uint32_t i = 0; i < 5; ++i) {
    CHECK(usual.scene.textures[i].width == kTextureSideUsual);
    const Texture &t = imported.scene.textures[i], rest = without_levels_beyond(usual.scene.textures[i], 64);
    REQUIRE(t.level_count == rest.level_count);
    for (std::uint32_t texel = 0; texel < level_texels(64, 64, t.level_count); ++texel)
      REQUIRE(imported.scene.texels[t.texel_begin + texel] == usual.scene.texels[rest.texel_begin + texel]);
  }
  Scene one = imported.scene, other = usual.scene;
  one.textures = other.textures = {}, one.texels = other.texels = {};
  CHECK(scene_hash(one) == scene_hash(other));
}

// Goal: the material samples show what they are made to show.
TEST_CASE("gltf_samples_materials_lights_and_cameras") {
  auto any = [](const ImportedScene& imported, auto test) {
    return std::any_of(imported.scene.materials.begin(), imported.scene.materials.end(), test);
  };
  std::string path;
  if (have(path = shared_scene("gltf/EmissiveStrengthTest.glb")))
    CHECK(any(load(path), [](const Material& m) { return std::fabs(max_component(m.emission) - 14.4f) < 1e-5f; }));
  if (have(path = shared_scene("gltf/UnlitTest.glb")))
    CHECK(any(load(path), [](const Material& m) { return m.unlit == 1; }));
  if (have(path = shared_scene("gltf/AttenuationTest.glb")))
    CHECK(any(load(path), [](const Material& m) { return max_component(m.absorption) > 0 && !m.thin; }));
  if (have(path = shared_scene("gltf/TransmissionTest.glb"))) {
    ImportOptions options;
    options.glass = GlassKind::thin;
    CHECK(any(load(path, options), [](const Material& m) { return m.transmission.x > 0 && m.thin; }));
    CHECK(any(load(path), [](const Material& m) { return m.transmission.x > 0 && !m.thin; }));
  }
  if (have(path = shared_scene("gltf/AlphaBlendModeTest.glb"))) {
    ImportedScene imported = load(path);
    CHECK(any(imported, [](const Material& m) { return m.alpha_mode == AlphaMode::mask; }));
    CHECK(any(imported, [](const Material& m) { return m.alpha_mode == AlphaMode::blend; }));
  }
  if (have(path = shared_scene("gltf/BoxVertexColors.glb"))) CHECK(load(path).scene.colors.count == 24);
  if (have(path = shared_scene("gltf/TextureSettingsTest.glb"))) {
    ImportedScene imported = load(path);
    for (Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
      CHECK(std::any_of(imported.scene.textures.begin(), imported.scene.textures.end(),
                        [&](const Texture& t) { return t.wrap_u == wrap; }));
  }
  if (have(path = shared_scene("gltf/LightsPunctualLamp/LightsPunctualLamp.gltf")))
    CHECK(load(path).scene.lights.count == 5);
  if (have(path = shared_scene("gltf/Lights.glb"))) {
    ImportedScene imported = load(path);
    CHECK(imported.scene.lights.count == 4);
    CHECK(imported.scene.cameras.count == 1);
  }
  if (have(path = shared_scene("gltf/Cameras/Cameras.gltf"))) {
    ImportedScene imported = load(path);
    REQUIRE(imported.scene.cameras.count == 2);
    CHECK(imported.scene.cameras[0].projection == Projection::perspective);
    CHECK(imported.scene.cameras[1].projection == Projection::orthographic);
  }
  if (have(path = shared_scene("cornell/bevy_CornellBox.glb")))
    CHECK(any(load(path), [](const Material& m) { return max_component(m.emission) > 1; }));
}
