// glTF textures that are missing or cannot be decoded, in other folders, or in other formats.
#include <sys/stat.h>

#include <vector>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "support/gltf_documents.h"
#ifdef POCKETRAY_HAVE_WEBP
#include <webp/encode.h>
#endif

using namespace pocketray;

namespace {

std::string with_image(const std::string& uri, const std::string& material) {
  return triangle_gltf(material, ",\"textures\":[{\"source\":0},{\"source\":1}],\"images\":[{\"uri\":\"" + uri +
                                     "\"},{\"uri\":\"" + kDotPng + "\"}]");
}

constexpr char kRed[] =
    "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":[1,0,0,1],"
    "\"baseColorTexture\":{\"index\":0}}}";

}  // namespace

// Goal: one texture that is missing or damaged does not refuse a model: it is named, and the factor's colour is shown;
// other textures stay. Method: every place that a material may name a texture in.
TEST_CASE("gltf_lost_textures_are_named_and_left_out") {
  TemporaryFolder folder;
  for (const char* uri : {"gone.png", "sub/t.png?v=2", "../gone.png", "/etc/hostname", "data:image/png;base64,AAAA",
                          "data:image/png;base64,!", "data:image/png,x"}) {
    CAPTURE(uri);
    ImportedScene imported = load(folder.write("a.gltf", with_image(uri, kRed)));
    CHECK(contains(imported.warning, "a texture is missing: "));
    CHECK(imported.scene.triangles.count == 1);
    CHECK(imported.scene.textures.count == 0);
    CHECK(imported.scene.materials[0].diffuse == Vec3{1, 0, 0});
  }
  const std::string lost = "\":{\"index\":0}", kept = "\":{\"index\":1}";
  for (const std::string& material :
       {"\"normalTexture" + lost, "\"occlusionTexture" + lost, "\"emissiveFactor\":[1,1,1],\"emissiveTexture" + lost,
        "\"pbrMetallicRoughness\":{\"metallicRoughnessTexture" + lost + "}",
        "\"extensions\":{\"KHR_materials_specular\":{\"specularTexture" + lost + ",\"specularColorTexture" + lost +
            "}}",
        "\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1,\"clearcoatTexture" + lost +
            ",\"clearcoatRoughnessFactor\":1,\"clearcoatRoughnessTexture" + lost + ",\"clearcoatNormalTexture" + lost +
            "}}",
        "\"extensions\":{\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,1,1],\"sheenColorTexture" + lost +
            ",\"sheenRoughnessFactor\":1,\"sheenRoughnessTexture" + lost + "}}",
        "\"extensions\":{\"KHR_materials_diffuse_transmission\":{\"diffuseTransmissionFactor\":1,"
        "\"diffuseTransmissionTexture" +
            lost + ",\"diffuseTransmissionColorTexture" + lost + "}}",
        "\"extensions\":{\"KHR_materials_iridescence\":{\"iridescenceFactor\":1,\"iridescenceTexture" + lost +
            ",\"iridescenceThicknessTexture" + lost + "}}",
        "\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_volume\":{\"thicknessFactor\":"
        "1,\"thicknessTexture" +
            lost + "},\"KHR_materials_transmission\":{\"transmissionFactor\":1}}",
        "\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1,\"transmissionTexture" + lost + "}}",
        "\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseTexture" + lost +
            ",\"specularGlossinessTexture" + lost + "}}",
        "\"extensions\":{\"KHR_materials_anisotropy\":{\"anisotropyStrength\":1,\"anisotropyTexture" + lost + "}}"}) {
    CAPTURE(material);
    ImportedScene imported = load(folder.write("a.gltf", with_image("gone.png", "{" + material + "}")));
    CHECK(imported.scene.textures.count == 0);
    CHECK(contains(imported.warning, "gone.png"));
  }
  ImportedScene half = load(
      folder.write("a.gltf", with_image("gone.png", "{\"normalTexture" + kept + ",\"occlusionTexture" + lost + "}")));
  CHECK(half.scene.textures.count == 1);
}

// Goal: "../" may lead to what stays in the model's folder, or below the folder given as root; nowhere else, and not by
// a root that does not hold the model. Method: files in folders beside the model's.
TEST_CASE("gltf_names_with_dots_stay_below_the_root") {
  TemporaryFolder folder;
  for (const char* name : {"/models", "/models/sub", "/tx", "/models2"})
    REQUIRE(mkdir((folder.path + name).c_str(), 0700) == 0);
  for (const char* name : {"tx/t.png", "models/t.png", "models2/t.png"}) {
    std::vector<std::uint8_t> png;
    REQUIRE(
        std::system(("printf %s '" + std::string(kDotPng + 22) + "' | base64 -d > '" + folder.path + "/" + name + "'")
                        .c_str()) == 0);
  }
  auto textures = [&](const char* uri, const std::string& root) {
    ImportOptions options;
    options.root = root;
    return load(folder.write("models/a.gltf", with_image(uri, kRed)), options).scene.textures.count;
  };
  CHECK(textures("t.png", "") == 1);
  CHECK(textures("sub/../t.png", "") == 1);
  CHECK(textures("sub/../../models/t.png", "") == 1);
  CHECK(textures("../models/./t.png", "") == 1);
  CHECK(textures("../tx/t.png", "") == 0);
  CHECK(textures("../models2/t.png", "") == 0);
  CHECK(textures("../tx/t.png", folder.path) == 1);
  CHECK(textures("..\\\\tx\\\\t.png", folder.path + "/") == 1);
  CHECK(textures("../tx/t.png", folder.path + "/tx/..") == 1);
  CHECK(textures("../tx/t.png", folder.path + "/models") == 0);
  CHECK(textures("../models2/t.png", folder.path + "/models") == 0);
  CHECK(textures("../../../../../../../../etc/hostname", folder.path) == 0);
  CHECK(textures("../tx", folder.path) == 0);
}

// Goal: WebP is read where the build has it, named by EXT_texture_webp or not; damaged ones are left out. Method: a
// picture encoded without loss, whole, cut short and changed.
TEST_CASE("gltf_webp_textures_are_read") {
#ifdef POCKETRAY_HAVE_WEBP
  const std::uint8_t texels[] = {255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255, 9, 9, 9, 255};
  std::uint8_t* encoded = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(texels, 2, 2, 8, &encoded);
  REQUIRE(size > 0);
  std::vector<std::uint8_t> bytes(encoded, encoded + size);
  WebPFree(encoded);
  TemporaryFolder folder;
  const std::string images = "\"images\":[{\"uri\":\"data:image/webp;base64," + base64(bytes) + "\"}]";
  ImportOptions plain;
  plain.mip_maps = false;
  for (const char* texture : {"{\"source\":0}", "{\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}}"}) {
    ImportedScene imported = load(
        folder.write("a.gltf", triangle_gltf(kRed, std::string(",\"textures\":[") + texture + "]," + images)), plain);
    REQUIRE(imported.scene.textures.count == 1);
    CHECK(std::memcmp(imported.scene.texels.data, texels, 12) == 0);
  }
  for (std::size_t cut = 12; cut < bytes.size(); ++cut) {
    const std::vector<std::uint8_t> part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(cut));
    ImportedScene imported = load(folder.write("a.gltf", with_image("data:image/webp;base64," + base64(part), kRed)));
    CHECK(imported.scene.triangles.count == 1);
  }
#else
  std::printf("skipped: this build has no libwebp\n");
#endif
}

// Goal: a WebP of a few bytes does not take the memory of 64 million texels. Method: pictures of one colour, which the
// coding makes as short; a small one is shown.
TEST_CASE("gltf_webp_of_one_colour_takes_no_more_memory_than_it_is_worth") {
#ifdef POCKETRAY_HAVE_WEBP
  TemporaryFolder folder;
  for (int side : {512, 8192}) {
    const std::vector<std::uint32_t> texels(std::size_t(side) * std::size_t(side), 0xFF8040FFu);
    std::uint8_t* encoded = nullptr;
    const std::size_t size =
        WebPEncodeLosslessRGBA(reinterpret_cast<const std::uint8_t*>(texels.data()), side, side, 4 * side, &encoded);
    REQUIRE(size > 0);
    const std::vector<std::uint8_t> bytes(encoded, encoded + size);
    WebPFree(encoded);
    CAPTURE(bytes.size());
    const ImportedScene imported =
        load(folder.write("a.gltf", with_image("data:image/webp;base64," + base64(bytes), kRed)));
    CHECK((imported.scene.textures.count == 1) == (side == 512));
    CHECK(contains(imported.warning, "8192 × 8192 pixels, more than its") == (side == 8192));
  }
#else
  std::printf("skipped: this build has no libwebp\n");
#endif
}
