// Diffuse transmission of glTF.
#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

// Goal: KHR_materials_diffuse_transmission is read with its textures, also shared ones; nothing of factor 0 or of an
// unlit material; metal and glass pass less. Method: examples; out of range and absent factors.
TEST_CASE("gltf_diffuse_transmission_is_read") {
  auto leaf = [](const std::string& passing, const std::string& more = "") {
    return "{\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{" + more +
           "\"KHR_materials_diffuse_transmission\":{" + passing + "}}}";
  };
  ImportedScene imported =
      load_gltf(triangle_gltf(leaf("\"diffuseTransmissionFactor\":0.5,\"diffuseTransmissionColorFactor\":[0.75,0.5,2],"
                                   "\"diffuseTransmissionTexture\":{\"index\":0},\"diffuseTransmissionColorTexture\":{"
                                   "\"index\":0,\"texCoord\":1}"),
                              kSmallTexture));
  CHECK(imported.warning.empty());
  REQUIRE(imported.scene.diffuse_transmissions.count == 1);
  const DiffuseTransmission& passing = imported.scene.diffuse_transmissions[0];
  CHECK((passing.strength == 0.5f && passing.color == Vec3{0.75f, 0.5f, 1}));
  CHECK(imported.scene.textures[passing.strength_texture.texture].uv_set == 0);
  CHECK(imported.scene.textures[passing.color_texture.texture].uv_set == 1);
  imported = load_gltf(triangle_gltf(leaf("\"diffuseTransmissionFactor\":3")));
  REQUIRE(imported.scene.diffuse_transmissions.count == 1);
  CHECK(imported.scene.diffuse_transmissions[0].strength == 1);
  CHECK(imported.scene.diffuse_transmissions[0].color == Vec3{1, 1, 1});
  for (const std::string& none :
       {leaf(""), leaf("\"diffuseTransmissionFactor\":-1,\"diffuseTransmissionTexture\":{\"index\":0}"),
        leaf("\"diffuseTransmissionFactor\":1,\"diffuseTransmissionTexture\":{\"index\":0}",
             "\"KHR_materials_unlit\":{},")}) {
    imported = load_gltf(triangle_gltf(none, kSmallTexture));
    CHECK((imported.scene.diffuse_transmissions.empty() && imported.scene.textures.empty()));
  }
  imported = load_gltf(triangle_gltf(
      "{\"pbrMetallicRoughness\":{\"metallicFactor\":0.25},\"extensions\":{\"KHR_materials_transmission\":{"
      "\"transmissionFactor\":0.5},\"KHR_materials_diffuse_transmission\":{"
      "\"diffuseTransmissionFactor\":1}}}"));
  REQUIRE(imported.scene.diffuse_transmissions.count == 1);
  CHECK(imported.scene.diffuse_transmissions[0].color == Vec3{0.375f, 0.375f, 0.375f});
}

// Goal: a message says that a body is rendered as if it were thin, and that a texture that lets nothing pass is left
// out. Method: examples.
TEST_CASE("gltf_diffuse_transmission_says_what_is_simplified") {
  const std::string volume = "\"KHR_materials_volume\":{\"thicknessFactor\":";
  auto body = [&](const char* thickness) {
    return load_gltf(triangle_gltf("{\"extensions\":{" + volume + thickness +
                                   "},\"KHR_materials_diffuse_transmission\":{\"diffuseTransmissionFactor\":1}}}"));
  };
  CHECK(body("0.5").warning.find("as if they were thin") != std::string::npos);
  CHECK(body("0").warning.empty());
}
