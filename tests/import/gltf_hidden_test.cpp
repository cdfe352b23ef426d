// Nodes that are not seen: by a scale of 0, or by KHR_node_visibility.
#include <cmath>
#include <vector>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "import/posed.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

ImportedScene load_nodes(const TemporaryFolder& folder, const GltfWriter& w, const std::string& nodes,
                         const std::string& roots, const std::string& rest = "") {
  return load(folder.write("a.gltf", w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                                            "\"nodes\":[" +
                                            nodes + "],\"scenes\":[{\"nodes\":[" + roots + "]}]" + rest)));
}

double area_of(const Scene& scene, const Array<Vec3>& positions) {
  double area = 0;
  for (const Triangle& t : scene.triangles) {
    const Vec3 a = positions[t.vertex(0)], b = positions[t.vertex(1)], c = positions[t.vertex(2)];
    area += 0.5 * static_cast<double>(length(cross(b - a, c - a)));
  }
  return area;
}

bool all_finite(const Pose& pose) {
  bool finite = true;
  for (const Vec3& p : pose.positions) finite &= is_finite(p);
  for (const Vec3& n : pose.normals) finite &= is_finite(n);
  return finite;
}

GltfWriter triangle_with_keys(const std::vector<float>& scales) {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.floats({0, 1, 2});
  w.vec3s(scales);
  return w;
}

}  // namespace

// Goal: HARDCASES row 70: a node of scale 0 on one axis or three is left out with what is below it, and named; what is
// beside it stays. Method: a matrix, a scale, a parent's scale.
TEST_CASE("hard_70_a_node_of_scale_0_is_hidden") {
  count_assertions("invisible while flat in volume");
  TemporaryFolder folder;
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  for (const char* hidden : {"\"scale\":[0,0,0]", "\"scale\":[1,0,1]", "\"scale\":[1,1,-0.0]",
                             "\"matrix\":[1,0,0,0,0,0,0,0,0,0,1,0,7,0,0,1]"}) {
    CAPTURE(hidden);
    const std::string nodes =
        std::string("{\"mesh\":0},{\"mesh\":0,\"name\":\"flat\",\"children\":[2],") + hidden + "},{\"mesh\":0}";
    ImportedScene imported = load_nodes(folder, w, nodes, "0,1");
    CHECK(imported.scene.triangles.count == 1);
    CHECK(contains(imported.warning, "node 1 'flat' is hidden"));
  }
  const std::string error = load_error(folder.write(
      "b.gltf", w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,"
                       "\"scale\":[0,0,0]}],\"scenes\":[{\"nodes\":[0]}]")));
  CHECK(contains(error, "hidden by its scale of 0"));
}

// Goal: HARDCASES row 70: a scale animated through 0 hides while it is 0, on one axis or three, for children as well;
// everything stays finite and neighbours do not change. Method: areas and positions around the time of 0.
TEST_CASE("hard_70_a_scale_animated_through_0_hides_then") {
  count_assertions("finite everywhere");
  TemporaryFolder folder;
  for (const std::vector<float>& scales :
       {std::vector<float>{1, 1, 1, 0, 0, 0, 1, 1, 1}, std::vector<float>{1, 1, 1, 1, 1, 0, 1, 1, 1},
        std::vector<float>{0, 0, 0, 1, 1, 1, 0, 0, 0}, std::vector<float>{1, 1, -1, 1, 1, 0, 1, 1, 1}}) {
    const double hidden = scales[0] == 0 ? 0 : 1, seen = 1 - hidden;
    ImportedScene imported = load_nodes(
        folder, triangle_with_keys(scales),
        "{\"mesh\":0,\"children\":[1]},{\"mesh\":0,\"translation\":[3,0,0]},{\"mesh\":0,\"translation\":[0,9,0]}",
        "0,2",
        ",\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],\"channels\":[{\"sampler\":0,\"target\":{"
        "\"node\":0,\"path\":\"scale\"}}]}]");
    const Scene& s = imported.scene;
    REQUIRE(s.triangles.count == 3);
    Posed posed(s);
    for (double time : {0.0, 0.5, 1.0, 1.5, 1.999}) {
      pose_at(s, 0, time, &posed.pose);
      CHECK(all_finite(posed.pose));
      CHECK(posed.pose.positions[s.triangles[2].vertex(0)] == Vec3{0, 9, 0});
    }
    pose_at(s, 0, hidden, &posed.pose);
    CHECK(area_of(s, posed.pose.positions) == 0.5);
    pose_at(s, 0, seen, &posed.pose);
    CHECK(area_of(s, posed.pose.positions) == 1.5);
  }
}

// Goal: HARDCASES row 70: a camera and a light below a node of scale 0 stay sound. Method: a scale animated from 0.
TEST_CASE("hard_70_cameras_and_lights_outlive_a_scale_of_0") {
  count_assertions("finite everywhere");
  TemporaryFolder folder;
  ImportedScene imported = load_nodes(
      folder, triangle_with_keys({0, 0, 0, 1, 1, 1, 0, 0, 0}),
      "{\"mesh\":0,\"children\":[1],\"translation\":[4,5,6]},{\"camera\":0,\"extensions\":{\"KHR_lights_punctual\":{"
      "\"light\":0}}},{\"mesh\":0}",
      "0,2",
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":0.1}}],\"extensions\":{"
      "\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\",\"intensity\":8}]}},\"animations\":[{"
      "\"samplers\":[{"
      "\"input\":1,\"output\":2}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}]}]");
  Posed posed(imported.scene);
  for (double time : {0.0, 0.5, 1.0}) {
    pose_at(imported.scene, 0, time, &posed.pose);
    const Camera& camera = posed.pose.cameras[0];
    CHECK(camera.eye == Vec3{4, 5, 6});
    CHECK(normalize(camera.target - camera.eye) == Vec3{0, 0, -1});
    CHECK(!is_zero(cross(camera.target - camera.eye, camera.up)));
    CHECK(posed.pose.lights[0].direction == Vec3{0, 0, -1});
  }
}

// Goal: HARDCASES row 70: a joint of scale 0 hides what follows it alone; normals stay finite. Method: a skinned
// triangle whose joint is scaled.
TEST_CASE("hard_70_a_joint_of_scale_0_hides_what_follows_it") {
  count_assertions("no NaN");
  GltfWriter w = triangle_with_keys({1, 1, 1, 1, 0, 1, 1, 1, 1});
  const int weights = w.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4, 5126),
            joints = w.add<std::uint8_t>(std::vector<std::uint8_t>(12, 0), "VEC4", 4, 5121),
            normals = w.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1});
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write(
      "a.gltf",
      w.gltf(
          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":" + std::to_string(normals) +
          ",\"WEIGHTS_0\":" + std::to_string(weights) + ",\"JOINTS_0\":" + std::to_string(joints) +
          "}}]}],\"skins\":[{\"joints\":[1]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{\"name\":\"bone\"}],\"scenes\":[{"
          "\"nodes\":"
          "[0,1]}],\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],\"channels\":[{\"sampler\":0,\"target\":{"
          "\"node\":1,\"path\":\"scale\"}}]}]")));
  Posed posed(imported.scene);
  CHECK(area_of(imported.scene, posed.pose.positions) == 0.5);
  pose_at(imported.scene, 0, 1, &posed.pose);
  CHECK(all_finite(posed.pose));
  CHECK(area_of(imported.scene, posed.pose.positions) == 0);
}

// Goal: KHR_node_visibility leaves out meshes and lights, also below the node, but no cameras; animated, it hides at
// times, and nodes at rest are as the file says. Method: a triangle and a light below a node that is switched.
TEST_CASE("gltf_node_visibility_hides_at_rest_and_animated") {
  TemporaryFolder folder;
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.floats({0, 1, 2});
  const int shown = w.add<std::uint8_t>({0, 1, 0}, "SCALAR", 1, 5121);
  const std::string nodes =
      "{\"mesh\":0},{\"children\":[2],\"extensions\":{\"KHR_node_visibility\":{\"visible\":false}}},{\"mesh\":0,"
      "\"camera\":0,\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}";
  const std::string rest =
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":0.1}}],\"extensions\":{"
      "\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"intensity\":8}]}}";
  ImportedScene still = load_nodes(folder, w, nodes, "0,1", rest);
  CHECK(still.scene.triangles.count == 1);
  CHECK(still.scene.lights.count == 0);
  CHECK(still.scene.cameras.count == 1);
  ImportedScene switched = load_nodes(
      folder, w, nodes, "0,1",
      rest + ",\"animations\":[{\"samplers\":[{\"input\":1,\"output\":" + std::to_string(shown) +
          ",\"interpolation\":\"STEP\"}],\"channels\":[{\"sampler\":0,\"target\":{\"path\":\"pointer\",\"extensions\":{"
          "\"KHR_animation_pointer\":{\"pointer\":\"/nodes/1/extensions/KHR_node_visibility/visible\"}}}}]}]");
  const Scene& s = switched.scene;
  REQUIRE(s.lights.count == 1);
  Posed posed(s);
  for (double time : {0.5, 1.5}) {
    pose_at(s, 0, time, &posed.pose);
    CHECK(area_of(s, posed.pose.positions) == (time < 1 ? 0.5 : 1.0));
    CHECK(posed.pose.lights[0].intensity == (time < 1 ? Vec3{0, 0, 0} : Vec3{8, 8, 8}));
  }
  pose_at(s, kNone, 1.5, &posed.pose);
  CHECK(area_of(s, posed.pose.positions) == 0.5);
}
