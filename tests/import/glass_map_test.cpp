// Textures of glass and thin films of glTF.
#include <cmath>

#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

namespace {

// 2 × 2 texels of (0, 128, 64), and one of (170, 85, 51).
const char* const kTexels =
    ",\"textures\":[{\"source\":0},{\"source\":1}],\"images\":[{\"uri\":\"data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAEElEQVR42mNgaHD4D8YwBgA5dAb9ejoCwQAAAABJRU5ErkJggg==\"},"
    "{\"uri\":\"data:image/"
    "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNYFWoMAALfATOu5SjFAAAAAElFTkSuQmCC\"}]";

ImportedScene load_text(const std::string& text, bool is_reduced = false) {
  TemporaryFolder folder;
  const std::string path = folder.write("scene.gltf", text);
  ImportOptions options;
  options.reduce = is_reduced;
  ImportedScene result;
  const Status status = import_scene(path, options, &result);
  CHECK_MESSAGE(status.ok, std::string(status.message));
  return result;
}

std::string glass(const std::string& transmission, const std::string& rest = "", const std::string& pbr = "") {
  return "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0" + pbr +
         "},\"extensions\":{\"KHR_materials_transmission\":{" + transmission + "}" + rest + "}}";
}

}  // namespace

// Goal: a transmission texture becomes a map, and the material has the lobes of its mean; of a black one, and over an
// unlit material, there is none. Method: examples; out of range and absent factors.
TEST_CASE("gltf_transmission_textures_are_maps") {
  const std::string texture = "\"transmissionTexture\":{\"index\":1,\"texCoord\":1}";
  ImportedScene imported = load_text(triangle_gltf(glass("\"transmissionFactor\":0.75," + texture), kTexels));
  CHECK(imported.warning ==
        "glass without a volume: 1 open or around something, taken as thin (--glass thin or solid)");
  REQUIRE(imported.scene.glass_maps.count == 1);
  const GlassMap& map = imported.scene.glass_maps[0];
  CHECK((map.transmission == 0.75f && map.thickness == 0 && map.thickness_texture.texture == kNone));
  CHECK(imported.scene.textures[map.transmission_texture.texture].uv_set == 0);  // the only set
  CHECK(imported.scene.materials[0].transmission.x == doctest::Approx(0.75 * 170 / 255));
  CHECK(imported.scene.materials[0].diffuse.x == doctest::Approx(1 - 0.75 * 170 / 255));
  CHECK(imported.scene.material_maps[0].model.base == Vec3{1, 1, 1});
  imported = load_text(triangle_gltf(glass("\"transmissionFactor\":7"), kTexels));
  CHECK(imported.scene.glass_maps[0].transmission == 1);
  for (const std::string& none : {glass(""), glass("\"transmissionFactor\":1,\"transmissionTexture\":{\"index\":0}"),
                                  glass("\"transmissionFactor\":1", ",\"KHR_materials_unlit\":{}")}) {
    imported = load_text(triangle_gltf(none, kTexels));
    CHECK((imported.scene.glass_maps.empty() && imported.scene.materials[0].transmission == Vec3{0, 0, 0}));
  }
}

// Goal: glass whose textures have one value, or none, is glass without maps, with the lobes that the map has. Method:
// reduced, against the factors.
TEST_CASE("gltf_even_glass_has_no_maps") {
  const std::string even = glass("\"transmissionFactor\":0.6,\"transmissionTexture\":{\"index\":1}", "",
                                 ",\"metallicRoughnessTexture\":{\"index\":0}");
  const Scene scenes[] = {load_text(triangle_gltf(even, kTexels), true).scene,
                          load_text(triangle_gltf(glass("\"transmissionFactor\":0.4")), true).scene};
  for (const Scene& scene : scenes)
    CHECK((scene.glass_maps.empty() && scene.material_maps.empty() && scene.textures.empty()));
  const ImportedScene a = load_text(triangle_gltf(even, kTexels), true),
                      b = load_text(triangle_gltf(glass("\"transmissionFactor\":0.4")), true);
  for (int c = 0; c < 3; ++c)
    CHECK(a.scene.materials[0].transmission[c] == doctest::Approx(b.scene.materials[0].transmission[c]));
  const ImportedScene tinted = load_text(
      triangle_gltf(glass("\"transmissionFactor\":1", "", ",\"baseColorTexture\":{\"index\":1}"), kTexels), true);
  REQUIRE(tinted.scene.glass_maps.count == 1);
  CHECK(tinted.scene.materials[0].diffuse_texture.texture != kNone);
}

// Goal: a thickness texture makes open meshes thin sheets that absorb, and leaves closed ones bodies. Method: a
// triangle, and a tetrahedron.
TEST_CASE("gltf_thickness_textures_are_of_open_meshes") {
  const std::string volume =
      ",\"KHR_materials_volume\":{\"thicknessFactor\":0.5,\"thicknessTexture\":{\"index\":1},\"attenuationDistance\":2,"
      "\"attenuationColor\":[0.5,0.25,1]}";
  const std::string material = glass("\"transmissionFactor\":1", volume);
  for (GlassKind kind : {GlassKind::automatic, GlassKind::thin, GlassKind::solid})
    for (bool is_closed : {false, true}) {
      GltfWriter w;
      std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
      if (is_closed)
        positions = {0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                     0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
      const std::string index = std::to_string(w.vec3s(positions));
      const std::string uvs = std::to_string(w.vec2s(std::vector<float>(positions.size() / 3 * 2, 0.5f)));
      TemporaryFolder folder;
      ImportOptions options;
      options.glass = kind;
      const ImportedScene imported =
          load(folder.write("scene.gltf",
                            w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":" + index +
                                   ",\"TEXCOORD_0\":" + uvs +
                                   "},\"material\":0}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],"
                                   "\"scene\":0,\"materials\":[" +
                                   material + "]" + kTexels)),
               options);
      CAPTURE(is_closed);
      CHECK(imported.warning.empty());
      CHECK(imported.scene.materials[0].thin == !is_closed);
      CHECK(imported.scene.materials[0].absorption.x == doctest::Approx(std::log(2.0) / 2));
      CHECK(imported.scene.glass_maps[0].thickness == (is_closed ? 0 : 0.5f));
      CHECK((imported.scene.glass_maps[0].thickness_texture.texture == kNone) == is_closed);
    }
}

// Goal: KHR_materials_iridescence becomes a film with its textures; none over an unlit material. Method: examples; out
// of range and absent values.
TEST_CASE("gltf_films_are_read") {
  auto film = [](const std::string& values) {
    return "{\"extensions\":{\"KHR_materials_iridescence\":{" + values + "}}}";
  };
  ImportedScene imported = load_text(
      triangle_gltf(film("\"iridescenceFactor\":0.5,\"iridescenceIor\":1.5,\"iridescenceThicknessMinimum\":200,"
                         "\"iridescenceThicknessMaximum\":600,\"iridescenceTexture\":{\"index\":0},"
                         "\"iridescenceThicknessTexture\":{\"index\":1}"),
                    kTexels));
  CHECK(imported.warning.empty());
  REQUIRE(imported.scene.iridescences.count == 1);
  const Iridescence& full = imported.scene.iridescences[0];
  CHECK((full.strength == 0.5f && full.ior == 1.5f && full.thickness_low == 200 && full.thickness_high == 600));
  CHECK((full.strength_texture.texture != kNone && full.thickness_texture.texture != full.strength_texture.texture));
  imported = load_text(
      triangle_gltf(film("\"iridescenceFactor\":3,\"iridescenceIor\":0.5,\"iridescenceThicknessMaximum\":-1")));
  const Iridescence& odd = imported.scene.iridescences[0];
  CHECK((odd.strength == 1 && odd.ior == 1 && odd.thickness_low == 100 && odd.thickness_high == 0));
  imported = load_text(triangle_gltf(film("\"iridescenceFactor\":1")));
  CHECK((imported.scene.iridescences[0].ior == 1.3f && imported.scene.iridescences[0].thickness_high == 400));
  for (const std::string& none :
       {film(""), std::string("{\"extensions\":{\"KHR_materials_unlit\":{},\"KHR_materials_iridescence\":{"
                              "\"iridescenceFactor\":1,\"iridescenceTexture\":{\"index\":0}}}}")}) {
    imported = load_text(triangle_gltf(none, kTexels));
    CHECK((imported.scene.iridescences.empty() && imported.scene.textures.empty()));
  }
  // Even textures become factors; a black one is none.
  imported = load_text(triangle_gltf(film("\"iridescenceFactor\":0.6,\"iridescenceTexture\":{\"index\":1},"
                                          "\"iridescenceThicknessTexture\":{\"index\":1}"),
                                     kTexels),
                       true);
  REQUIRE(imported.scene.iridescences.count == 1);
  CHECK(imported.scene.iridescences[0].strength == doctest::Approx(0.4));
  CHECK(imported.scene.iridescences[0].thickness_high == doctest::Approx(200));
  CHECK(imported.scene.textures.empty());
  imported =
      load_text(triangle_gltf(film("\"iridescenceFactor\":1,\"iridescenceTexture\":{\"index\":0}"), kTexels), true);
  CHECK(imported.scene.iridescences.empty());
}
