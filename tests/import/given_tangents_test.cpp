// Tangents that a glTF file gives.
#include <algorithm>
#include <limits>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "scene/scene.h"

using namespace pocketray;

namespace {

const char* const kBumpy = "{\"normalTexture\":{\"index\":0}}";
const char* const kTurned = "\"rotation\":[0,0,0.70710678,0.70710678]";  // x to y
const char* const kPlain = "{\"pbrMetallicRoughness\":{\"metallicFactor\":0}}";

struct Given {
  std::vector<float> tangents;
  const char* material = kBumpy;
  std::string node = "";
  bool with_normals = true;
  std::string rest = "";
};

std::vector<float> four(const std::vector<float>& one) {
  std::vector<float> all;
  for (int i = 0; i < 4; ++i) all.insert(all.end(), one.begin(), one.end());
  return all;
}

// A square in the plane z = 0, its front towards +z, whose u runs along x and v against y, with a tangent per vertex.
ImportedScene square(const Given& given) {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  w.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  w.vec2s({0, 1, 1, 1, 1, 0, 0, 0});
  w.indices({0, 1, 2, 0, 2, 3});
  w.add(given.tangents, "VEC4", 4, 5126);
  w.floats({0, 1});
  w.vec3s({0, 0, 0, 0, 0, 1});
  w.vec3s({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1});
  w.add(std::vector<std::uint8_t>(16, 0), "VEC4", 4, 5121);
  w.add(four({1, 0, 0, 0}), "VEC4", 4, 5126);
  const std::string normals = given.with_normals ? "\"NORMAL\":1," : "";
  TemporaryFolder folder;
  return load(folder.write(
      "square.gltf",
      w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0," + normals +
             "\"TEXCOORD_0\":2,\"TANGENT\":4,\"JOINTS_0\":8,\"WEIGHTS_0\":9},\"targets\":[{\"POSITION\":7}],"
             "\"indices\":3,\"material\":0}]}],\"nodes\":["
             "{\"mesh\":0" +
             given.node + "},{" + kTurned + "}],\"scenes\":[{\"nodes\":[0,1]}],\"scene\":0,\"materials\":[" +
             given.material +
             "],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
             "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==\"}]" +
             given.rest)));
}

void check_all(const ImportedScene& imported, const PackedTangent& expected) {
  REQUIRE(imported.scene.tangents.count == 4);
  for (const PackedTangent& t : imported.scene.tangents) {
    CHECK(unpacked(t) == unpacked(expected));
    CHECK(t.handedness == expected.handedness);
  }
}

}  // namespace

// Goal: tangents of the file are the scene's, with their handedness, perpendicular to the normal and placed as the node
// is: turned, stretched, mirrored. Method: closed forms.
TEST_CASE("given_tangents_are_read") {
  check_all(square({four({0, 1, 0, 1})}), {0, 127, 0, 1});
  check_all(square({four({0, 5, 0, -1})}), {0, 127, 0, -1});
  check_all(square({four({0.6f, -0.8f, 0.5f, 1})}), {76, -102, 0, 1});
  check_all(square({four({0, 1, 0, 1}), kBumpy, std::string(",") + kTurned}), {-127, 0, 0, 1});
  check_all(square({four({1, 1, 0, 1}), kBumpy, ",\"scale\":[3,4,7]"}), {76, 102, 0, 1});
  check_all(square({four({1, 1, 0, 1}), kBumpy, ",\"scale\":[-3,4,7]"}), {-76, 102, 0, -1});
  const char* skin = ",\"skins\":[{\"joints\":[1]}]";
  check_all(square({four({0, 1, 0, -1}), kBumpy, ",\"skin\":0", true, skin}), {-127, 0, 0, -1});
  CHECK(square({four({0, 1, 0, 1})}).warning.empty());
}

// Goal: nothing is stored where no map needs tangents; without normals, after a morph and where the mesh moves, those
// of the file are not used, without a remark. Method: such files; made tangents lie along x and have no handedness.
TEST_CASE("given_tangents_are_left_out") {
  CHECK(square({four({0, 1, 0, 1}), kPlain}).scene.tangents.empty());
  check_all(square({four({0, 1, 0, 1}), kBumpy, "", false}), {127, 0, 0, 0});
  check_all(square({four({0, 1, 0, 1}), kBumpy, ",\"weights\":[0]"}), {0, 127, 0, 1});
  const Vec3 morphed = unpacked(square({four({0, 1, 0, 1}), kBumpy, ",\"weights\":[1]"}).scene.tangents[0]);
  CHECK(morphed == Vec3{127, 0, 0});
  const std::string moves =
      ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
      "\"samplers\":[{\"input\":5,\"output\":6}]}]";
  const ImportedScene moving = square({four({0, 1, 0, 1}), kBumpy, "", true, moves});
  check_all(moving, {0, 0, 0, 0});
  CHECK(moving.warning.empty());
}

// Goal: a tangent that is zero, along the normal or without handedness is made anew, and so are all where one is not
// finite or where their number is not that of the vertices; a remark says so. Method: one such vertex among good ones.
TEST_CASE("given_tangents_that_are_unusable_are_made_anew") {
  for (const auto& bad : {std::vector<float>{0, 0, 0, 1}, {0, 0, 2, 1}, {0, 1, 0, 0}}) {
    std::vector<float> tangents = four({0, 1, 0, -1});
    std::copy(bad.begin(), bad.end(), tangents.begin());
    const ImportedScene imported = square({tangents});
    CHECK(imported.warning == "tangents that are zero, along the normal or without handedness are recomputed");
    REQUIRE(imported.scene.tangents.count == 4);
    CHECK(unpacked(imported.scene.tangents[0]) == Vec3{127, 0, 0});
    CHECK(imported.scene.tangents[0].handedness == 0);
    CHECK(unpacked(imported.scene.tangents[1]) == Vec3{0, 127, 0});
    CHECK(imported.scene.tangents[1].handedness == -1);
  }
  std::vector<float> tangents = four({0, 1, 0, -1});
  tangents[5] = std::numeric_limits<float>::quiet_NaN();
  const ImportedScene not_finite = square({tangents}), three = square({{0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}});
  check_all(not_finite, {127, 0, 0, 0}), check_all(three, {127, 0, 0, 0});
  CHECK(contains(not_finite.warning, "tangents are recomputed: TANGENT: element 1 of accessor 4 is nan"));
  CHECK(contains(three.warning, "tangents are recomputed: TANGENT: 3 elements for 4 vertices"));
}
