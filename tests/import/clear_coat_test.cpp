// Clear coats of glTF.
#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

// Goal: KHR_materials_clearcoat becomes a clear coat with its textures; none without strength or over an unlit
// material; the least roughness is the texture's. Method: examples; out of range and absent factors.
TEST_CASE("gltf_clear_coats_are_read") {
  auto coated = [](const char* coat, const char* more = "") {
    return "{\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_clearcoat\":{" +
           std::string(coat) + "}}" + more + "}";
  };
  ImportedScene imported =
      load_gltf(triangle_gltf(coated("\"clearcoatFactor\":0.75,\"clearcoatRoughnessFactor\":0.5,\"clearcoatTexture\":{"
                                     "\"index\":0},\"clearcoatRoughnessTexture\":{\"index\":0,\"texCoord\":1},"
                                     "\"clearcoatNormalTexture\":{\"index\":0,\"scale\":0.25}"),
                              kSmallTexture));
  CHECK(imported.warning.empty());
  REQUIRE(imported.scene.clear_coats.count == 1);
  const ClearCoat& coat = imported.scene.clear_coats[0];
  CHECK((coat.strength == 0.75f && coat.roughness == 0.5f && coat.normal_scale == 0.25f));
  CHECK(coat.roughness_low == 0.5f * (128 / 255.0f));
  CHECK(imported.scene.textures[coat.strength_texture.texture].uv_set == 0);
  CHECK(imported.scene.textures[coat.roughness_texture.texture].uv_set == 1);
  CHECK(imported.scene.textures[coat.normal.texture].uv_set == 0);
  CHECK((imported.scene.tangents.count == 3 && !is_zero(unpacked(imported.scene.tangents[0]))));
  imported = load_gltf(triangle_gltf(coated("\"clearcoatFactor\":7")));
  REQUIRE(imported.scene.clear_coats.count == 1);
  CHECK((imported.scene.clear_coats[0].strength == 1 && imported.scene.clear_coats[0].roughness == 0));
  for (const std::string& none :
       {coated(""), coated("\"clearcoatFactor\":0,\"clearcoatTexture\":{\"index\":0}"),
        std::string("{\"extensions\":{\"KHR_materials_unlit\":{},\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1,"
                    "\"clearcoatTexture\":{\"index\":0}}}}")}) {
    imported = load_gltf(triangle_gltf(none, kSmallTexture));
    CHECK((imported.scene.clear_coats.empty() && imported.scene.textures.empty()));
  }
  // Its normals have the frame of the base's.
  imported =
      load_gltf(triangle_gltf(coated("\"clearcoatFactor\":1,\"clearcoatNormalTexture\":{\"index\":0,\"texCoord\":1}",
                                     ",\"normalTexture\":{\"index\":0}"),
                              kSmallTexture));
  CHECK(imported.warning == "not used: normal textures of clear coats with texture coordinates other than the base's");
  CHECK(imported.scene.clear_coats[0].normal.texture == kNone);
}
