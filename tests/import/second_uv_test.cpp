// Textures of a material that use two sets of texture coordinates.
#include <cstring>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "scene/baked_file.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// 2 × 2 texels: red, green / half-transparent blue, transparent white.
const char* const kColors =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFUlEQVR42mP4z8DwHwyBdMP///8ZAEZOCHkCeX4dAAAAAElFTkSuQmCC";
// One texel of (128, 128, 255): normals as they are.
const char* const kFlat =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==";

// A panel before a wall. `sets` are the accessors of its TEXCOORD_0 and _1: 1 or 2; of the first the panel is a square,
// of the second it is turned and mirrored. `materials` are that of the panel and that of the wall.
ImportedScene panel(const std::string& material, const char* sets, bool moving = false) {
  GltfWriter w;
  w.vec3s({9, 9, 9, -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});  // no triangle has the first
  w.vec2s({7, 7, 0, 1, 1, 1, 1, 0, 0, 0});
  w.vec2s({8, 8, 0.25f, 0.125f, 0.25f, 1.625f, 1.75f, 1.625f, 1.75f, 0.125f});
  w.indices({1, 2, 3, 1, 3, 4});
  w.vec3s({9, 9, 9, -4, -4, -1, 4, -4, -1, 4, 4, -1, -4, 4, -1});
  w.floats({0, 1});
  w.vec3s({0, 0, 0, 0.5f, 0.25f, 0.5f});
  const std::string attributes = std::string("\"TEXCOORD_0\":") + sets[0] + (sets[1] ? ",\"TEXCOORD_1\":" : "") +
                                 (sets[1] ? std::string(1, sets[1]) : "");
  std::string text =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0," + attributes +
      "},\"indices\":3,\"material\":0}]},{\"primitives\":[{\"attributes\":{\"POSITION\":4},\"indices\":3,"
      "\"material\":1}]}],\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"scenes\":[{\"nodes\":[0,1]}],\"scene\":"
      "0,\"materials\":[" +
      material + ",{}],\"images\":[{\"uri\":\"" + kColors + "\"},{\"uri\":\"" + kFlat +
      "\"}],\"textures\":[{\"source\":0},{\"source\":1}]";
  if (moving)
    text +=
        ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
        "\"samplers\":[{\"input\":5,\"output\":6}]}]";
  TemporaryFolder folder;
  return load(folder.write("panel.gltf", w.gltf(text)));
}

// A look at the panel from the front right, lit from the front left.
Scene lit(const ImportedScene& imported, const Camera& camera, const Light& light) {
  Scene scene = imported.scene;
  scene.cameras = {&camera, 1}, scene.lights = {&light, 1};
  scene.info.ambient = {0.25f, 0.5f, 0.75f}, scene.info.default_lights = scene.info.default_camera = 0;
  return scene;
}

struct View {
  Camera camera;
  Light light;
  View() {
    camera.eye = {1.5f, 0.5f, 4}, camera.target = {0, 0, 0};
    light.position = {-2, 1, 3}, light.intensity = {20, 18, 15};
  }
};

Picture picture(const ImportedScene& imported, TextureFilter filter = TextureFilter::as_scene) {
  const View view;
  const Scene scene = lit(imported, view.camera, view.light);
  Settings settings;
  settings.width = 48, settings.height = 36, settings.texture_filter = filter;
  return render_picture(scene, settings, 0.5);
}

const std::string kInfo = "{\"index\":0,\"texCoord\":SET,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[7,6]}}}";
// A texture in each place of a material, `KHR_…` and all.
const struct {
  const char* name;
  const char* json;
} kSlots[] = {
    {"base colour", "\"pbrMetallicRoughness\":{\"baseColorTexture\":INFO}"},
    {"metal", "\"pbrMetallicRoughness\":{\"baseColorTexture\":INFO,\"metallicFactor\":1,\"roughnessFactor\":0.4}"},
    {"metallic-roughness", "\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":INFO}"},
    {"emission", "\"emissiveFactor\":[1,1,1],\"emissiveTexture\":INFO"},
    {"occlusion", "\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"occlusionTexture\":INFO"},
    {"specular",
     "\"pbrMetallicRoughness\":{\"metallicFactor\":0},\"extensions\":{\"KHR_materials_specular\":{"
     "\"specularTexture\":INFO,\"specularColorTexture\":INFO}}"},
    {"holes", "\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":INFO}"},
    {"layers", "\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorTexture\":INFO}"},
};

std::string replaced(std::string text, const std::string& part, const std::string& by) {
  for (std::size_t at; (at = text.find(part)) != std::string::npos;) text.replace(at, part.size(), by);
  return text;
}

// The material with its textures on `set`, beside a normal texture on set 0 that changes nothing, so that set 0 is the
// first.
std::string material_on(const char* json, const char* set, const char* more = ",\"normalTexture\":{\"index\":1}") {
  return "{\"doubleSided\":true," + replaced(json, "INFO", replaced(kInfo, "SET", set)) + more + "}";
}

}  // namespace

// Goal: a texture on either of two sets shows as if its set were the only one. Method: each kind of texture on set 1;
// the same model with the sets changed over by hand; and without the other set at all. Pictures are equal, bit for bit,
// with each filter, and those of the other set are not.
TEST_CASE("gltf_textures_of_the_second_set_show_as_if_it_were_the_only_one") {
  for (const auto& slot : kSlots) {
    CAPTURE(std::string(slot.name));
    const ImportedScene second = panel(material_on(slot.json, "1"), "12"),
                        alone = panel(material_on(slot.json, "0", ""), "2");
    const ImportedScene swapped = panel(material_on(slot.json, "0"), "21"),
                        first = panel(material_on(slot.json, "0"), "12");
    REQUIRE(second.scene.second_uvs.count == second.scene.positions.count);
    for (const ImportedScene* one : {&alone, &swapped, &first}) CHECK(one->scene.second_uvs.empty());
    CHECK(second.warning == alone.warning);
    for (TextureFilter filter : {TextureFilter::as_scene, TextureFilter::nearest, TextureFilter::anisotropic}) {
      const Picture seen = picture(second, filter);
      CHECK(same_picture(seen, picture(alone, filter)));
      CHECK(same_picture(seen, picture(swapped, filter)));
      CHECK_FALSE(same_picture(seen, picture(first, filter)));
    }
  }
}

// Goal: both sets at once, in either order, in a mesh that moves too, and from a file baked for the device. Method:
// base colour on set 0 and occlusion on set 1, then the other way about with the sets exchanged: the same picture.
TEST_CASE("gltf_both_sets_show_at_once") {
  for (const char* other : {"\"occlusionTexture\":OTHER", "\"emissiveFactor\":[1,1,1],\"emissiveTexture\":OTHER"})
    for (const bool moving : {false, true}) {
      auto material = [&](const char* base, const char* rest) {
        return "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":" + replaced(kInfo, "SET", base) +
               "}," + replaced(other, "OTHER", replaced(kInfo, "SET", rest)) + "}";
      };
      const ImportedScene straight = panel(material("0", "1"), "12", moving);
      const ImportedScene crossed = panel(material("1", "0"), "21", moving);
      const ImportedScene mixed = panel(material("1", "0"), "12", moving),
                          same = panel(material("0", "0"), "12", moving);
      CAPTURE(std::string(other));
      CHECK(straight.scene.moving_meshes.count == (moving ? 1 : 0));
      CHECK(straight.scene.textures.count == 2);
      CHECK(straight.scene.texels.count <= 10);  // one image of numbers, one of colours
      CHECK(straight.warning.empty());
      const Picture seen = picture(straight);
      CHECK(same_picture(seen, picture(crossed)));
      CHECK_FALSE(same_picture(seen, picture(mixed)));
      CHECK_FALSE(same_picture(seen, picture(same)));
      const BakedFile file = bake(straight.scene);
      ImportedScene opened;
      REQUIRE(baked_open(file.data(), file.size(), &opened.scene).ok);
      CHECK(opened.scene.second_uvs.count == straight.scene.second_uvs.count);
      CHECK(same_picture(seen, picture(opened)));
      CHECK(baked_size(straight.scene) > baked_size(same.scene));
    }
}

// Goal: a normal map keeps its own set, whose frame it has, whatever the others use; a set that only the transform
// names counts; a third set is named. Method: which coordinates the scene has, and the warning.
TEST_CASE("gltf_sets_are_those_of_the_normal_map_and_one_more") {
  auto scene_of = [](const std::string& json) { return panel(json, "12"); };
  const ImportedScene normal = scene_of(
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"normalTexture\":{\"index\":1,\"extensions\":{"
      "\"KHR_texture_transform\":{\"texCoord\":1}}}}");
  const Scene& s = normal.scene;
  CHECK(normal.warning.empty());
  REQUIRE(s.second_uvs.count == s.positions.count);
  CHECK((s.uvs[0].x == 0.25f && s.second_uvs[0].x == 0));
  CHECK(s.textures[s.material_maps[0].normal.texture].uv_set == 0);
  CHECK(s.textures[s.materials[0].diffuse_texture.texture].uv_set == 1);
  for (std::uint32_t i = 4; i < 8; ++i) CHECK((s.second_uvs[i].x == 0 && s.second_uvs[i].y == 0));  // the wall has none
  const ImportedScene third = scene_of(
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{"
      "\"index\":0,\"texCoord\":1},\"occlusionTexture\":{\"index\":0,\"texCoord\":2}}");
  CHECK(third.warning ==
        "occlusion textures use the texture coordinates of the base colour, a third set being left out");
  CHECK(third.scene.textures[third.scene.material_maps[0].occlusion.texture].uv_set == 0);
  const ImportedScene absent = panel(
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"occlusionTexture\":{\"index\":0,\"texCoord\":"
      "1}}",
      "1");
  CHECK(absent.warning == "a mesh lacks TEXCOORD_1, which its material uses");
  REQUIRE(absent.scene.second_uvs.count == absent.scene.positions.count);
  // Nothing is kept for a texture that has no effect.
  const ImportedScene dark = scene_of(
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"emissiveTexture\":{\"index\":0,\"texCoord\":1}"
      "}");
  CHECK(dark.scene.second_uvs.empty());
  // Glass keeps its textures.
  const ImportedScene clear = scene_of(
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},\"metallicFactor\":0,\"metallicRoughnessTexture\":"
      "{"
      "\"index\":1,\"texCoord\":1}},\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}}}");
  CHECK(!is_zero(clear.scene.materials[0].transmission));
  CHECK((clear.scene.uvs.count > 0 && clear.scene.second_uvs.count > 0));
}
