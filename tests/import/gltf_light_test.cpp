// Lights and cameras of glTF.
#include <cmath>
#include <string>

#include "desktop/import/reduce.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

namespace {

ImportedScene load_text(const std::string& text) {
  TemporaryFolder folder;
  return load(folder.write("scene.gltf", text));
}
void check_vec(const Vec3& a, const Vec3& b) {
  for (int c = 0; c < 3; ++c) CHECK(a[c] == doctest::Approx(b[c]).epsilon(1e-5));
}

}  // namespace

// Goal: punctual lights with kind, place, direction, cone and range. Method: a node that turns −z to +x.
TEST_CASE("gltf_punctual_lights_follow_their_node") {
  std::string lights =
      ",\"extensionsRequired\":[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{"
      "\"type\":\"spot\","
      "\"intensity\":50,\"color\":[1,0.5,0],\"range\":9,\"spot\":{\"innerConeAngle\":0.5,\"outerConeAngle\":0.7}},"
      "{\"type\":\"directional\",\"intensity\":3}]}}";
  std::string node =
      ",\"translation\":[1,2,3],\"rotation\":[0,-0.70710678,0,0.70710678],\"extensions\":{\"KHR_lights_punctual\":{"
      "\"light\":0}}},"
      "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}";
  std::string text = triangle_gltf("", lights, node);
  text.replace(text.find("\"nodes\":[0]"), 11, "\"nodes\":[0,1]");
  ImportedScene imported = load_text(text);
  REQUIRE(imported.scene.lights.count == 2);
  const Light& spot = imported.scene.lights[0];
  CHECK(spot.kind == LightKind::spot);
  CHECK(spot.position == Vec3{1, 2, 3});
  CHECK(spot.direction.x == doctest::Approx(1));
  check_vec(spot.intensity, {50, 25, 0});
  CHECK(spot.range == 9);
  CHECK(spot.cos_inner == doctest::Approx(std::cos(0.5)));
  CHECK(spot.cos_outer == doctest::Approx(std::cos(0.7)));
  CHECK(imported.scene.lights[1].kind == LightKind::directional);
  CHECK(imported.scene.lights[1].direction == Vec3{0, 0, -1});
  CHECK(imported.scene.info.auto_exposure == 1);
  CHECK(load_text(triangle_gltf("")).scene.info.auto_exposure == 0);
}

// Goal: a cone whose angles are close gets the soft edge that KHR_lights_punctual gives it. Method: its formula at the
// middle of the edge, where the cosine is 0.0005 above that of the outer angle.
TEST_CASE("gltf_spot_cones_keep_a_soft_edge") {
  for (const char* inner : {"0.7", "0.69999"}) {
    std::string lights = R"(,"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{"innerConeAngle":)";
    lights += std::string(inner) + R"(,"outerConeAngle":0.7}}]}})";
    ImportedScene imported =
        load_text(triangle_gltf("", lights, R"(,"extensions":{"KHR_lights_punctual":{"light":0}})"));
    REQUIRE(imported.scene.lights.count == 1);
    const Light& spot = imported.scene.lights[0];
    double middle = std::cos(0.7) + 0.0005;
    double f = (middle - double(spot.cos_outer)) / (double(spot.cos_inner) - double(spot.cos_outer));
    CHECK(f == doctest::Approx(0.5).epsilon(1e-3));
  }
}

// Goal: a camera's near plane is kept where a triangle lies before it, or may come to lie there.
TEST_CASE("near_planes_are_kept_where_they_cut") {
  auto near_of = [](float distance, Projection projection, bool moves) {
    SceneArrays arrays;
    arrays.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    arrays.triangles = {Triangle(0, 1, 2, 0)};
    arrays.materials.resize(1);
    Camera camera;
    camera.eye = {0, 1, 5}, camera.target = {0, 1, 4}, camera.projection = projection;
    if (moves) camera.node = 0, arrays.nodes.resize(1);
    arrays.cameras = {camera};
    arrays.camera_near = {distance};
    reduce(&arrays);
    return arrays.camera_near.empty() ? 0 : arrays.camera_near[0];
  };
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    CHECK(near_of(0.1f, projection, false) == 0);
    CHECK(near_of(4.5f, projection, false) == 0);
    CHECK(near_of(5.5f, projection, false) == 5.5f);
    CHECK(near_of(0.1f, projection, true) == 0.1f);
  }
}

// Goal: perspective and orthographic cameras stand where their node is; an invalid camera is skipped with a note.
TEST_CASE("gltf_cameras_stand_where_their_node_is") {
  auto with_camera = [](const std::string& camera) {
    return triangle_gltf("", ",\"cameras\":[" + camera + "]", ",\"camera\":0,\"translation\":[0,1,5]");
  };
  ImportedScene a = load_text(with_camera("{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":0.1}}"));
  REQUIRE(a.scene.cameras.count == 1);
  CHECK(a.scene.cameras[0].projection == Projection::perspective);
  CHECK(a.scene.cameras[0].vertical_fov == 0.7f);
  CHECK(a.scene.cameras[0].eye == Vec3{0, 1, 5});
  CHECK(a.scene.cameras[0].target == Vec3{0, 1, 4});
  CHECK(a.scene.cameras[0].up == Vec3{0, 1, 0});
  ImportedScene b = load_text(
      with_camera("{\"type\":\"orthographic\",\"orthographic\":{\"xmag\":2,\"ymag\":1.5,\"znear\":0.1,\"zfar\":9}}"));
  REQUIRE(b.scene.cameras.count == 1);
  CHECK(b.scene.cameras[0].projection == Projection::orthographic);
  CHECK(b.scene.cameras[0].vertical_extent == 3);
  REQUIRE(b.scene.camera_near.count == 1);
  CHECK(b.scene.camera_near[0] == 0.1f);
  ImportedScene none =
      load_text(with_camera("{\"type\":\"perspective\",\"perspective\":{\"yfov\":3.2,\"znear\":0.1}}"));
  CHECK(none.scene.cameras.count == 0);
  CHECK(contains(none.warning, "cameras without a valid view"));
}
