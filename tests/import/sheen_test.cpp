// Sheens of glTF.
#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

// Goal: KHR_materials_sheen becomes a sheen with its textures; none of a black one or over an unlit material; the least
// roughness is the texture's. Method: examples; out of range and absent factors.
TEST_CASE("gltf_sheens_are_read") {
  auto cloth = [](const char* sheen) {
    return "{\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_sheen\":{" +
           std::string(sheen) + "}}}";
  };
  ImportedScene imported = load_gltf(
      triangle_gltf(cloth("\"sheenColorFactor\":[0.75,0.5,0.25],\"sheenRoughnessFactor\":0.5,\"sheenColorTexture\":{"
                          "\"index\":0},\"sheenRoughnessTexture\":{\"index\":0,\"texCoord\":1}"),
                    kSmallTexture));
  CHECK(imported.warning.empty());
  REQUIRE(imported.scene.sheens.count == 1);
  const Sheen& sheen = imported.scene.sheens[0];
  CHECK((sheen.color == Vec3{0.75f, 0.5f, 0.25f} && sheen.roughness == 0.5f && sheen.roughness_low == 0.5f));
  CHECK(imported.scene.textures[sheen.color_texture.texture].uv_set == 0);
  CHECK(imported.scene.textures[sheen.roughness_texture.texture].uv_set == 1);
  imported = load_gltf(triangle_gltf(cloth("\"sheenColorFactor\":[7,0,-1],\"sheenRoughnessFactor\":3")));
  REQUIRE(imported.scene.sheens.count == 1);
  CHECK((imported.scene.sheens[0].color == Vec3{1, 0, 0} && imported.scene.sheens[0].roughness == 1));
  imported = load_gltf(
      triangle_gltf(cloth("\"sheenColorFactor\":[1,1,1],\"sheenRoughnessTexture\":{\"index\":0}"), kSmallTexture));
  CHECK((imported.scene.sheens[0].roughness == 0 && imported.scene.sheens[0].roughness_texture.texture == kNone));
  for (const std::string& none :
       {cloth(""), cloth("\"sheenRoughnessFactor\":1,\"sheenColorTexture\":{\"index\":0}"),
        std::string("{\"extensions\":{\"KHR_materials_unlit\":{},\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,1,1],"
                    "\"sheenColorTexture\":{\"index\":0}}}}")}) {
    imported = load_gltf(triangle_gltf(none, kSmallTexture));
    CHECK((imported.scene.sheens.empty() && imported.scene.textures.empty()));
  }
}
