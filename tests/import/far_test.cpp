// Models far from the origin, as in the coordinates of maps.
#include <cmath>
#include <vector>

#include "desktop/import/origin.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "scene/baked_file.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

struct Offset {
  const char *x, *y, *z;  // decimals, so that they are the same number in every file
};
constexpr Offset kUtm = {"431250.37", "120.5", "5411875.62"};

// A bumpy grid, with details of a thousandth: x, y, z in thousandths, which a text carries exactly.
std::vector<int> grid() {
  std::vector<int> thousandths;
  for (int i = 0; i <= 40; ++i)
    for (int k = 0; k <= 40; ++k)
      thousandths.insert(thousandths.end(),
                         {250 * (i - 20), (7 * i * i + 13 * k * k + i * k) % 91 - 45, 250 * (k - 20)});
  return thousandths;
}
std::string decimal(const char* offset, int thousandths) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3f", std::strtod(offset, nullptr) + thousandths * 1e-3);
  return text;
}
std::vector<int> faces() {
  std::vector<int> list;
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 40; ++k) {
      const int a = 41 * i + k;
      list.insert(list.end(), {a, a + 1, a + 41, a + 1, a + 42, a + 41});
    }
  return list;
}
std::string obj(const Offset& o) {
  std::string text;
  const std::vector<int> points = grid(), corners = faces();
  for (std::size_t i = 0; i < points.size(); i += 3)
    text +=
        "v " + decimal(o.x, points[i]) + " " + decimal(o.y, points[i + 1]) + "\t" + decimal(o.z, points[i + 2]) + "\n";
  for (std::size_t i = 0; i < corners.size(); i += 3)
    text += "f " + std::to_string(corners[i] + 1) + " " + std::to_string(corners[i + 1] + 1) + " " +
            std::to_string(corners[i + 2] + 1) + "\n";
  return text;
}
std::string ply(const Offset& o, const char* type) {
  const std::vector<int> points = grid(), corners = faces();
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size() / 3);
  for (const char* axis : {"x", "y", "z"}) text += std::string("\nproperty ") + type + " " + axis;
  text +=
      "\nelement face " + std::to_string(corners.size() / 3) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < points.size(); i += 3)
    text += decimal(o.x, points[i]) + " " + decimal(o.y, points[i + 1]) + " " + decimal(o.z, points[i + 2]) + "\n";
  for (std::size_t i = 0; i < corners.size(); i += 3)
    text += "3 " + std::to_string(corners[i]) + " " + std::to_string(corners[i + 1]) + " " +
            std::to_string(corners[i + 2]) + "\n";
  return text;
}
std::string gltf(const std::string& nodes) {
  GltfWriter w;
  std::vector<float> points;
  std::vector<std::uint16_t> corners;
  for (int x : grid()) points.push_back(static_cast<float>(x * 1e-3));
  for (int corner : faces()) corners.push_back(static_cast<std::uint16_t>(corner));
  w.add(points, "VEC3", 3, 5126, ",\"min\":[-5,-0.045,-5],\"max\":[5,0.045,5]");
  w.indices(corners);
  w.floats({0, 1});
  w.vec3s({431250.5f, 120, 5411875, 431251.5f, 120, 5411875});
  w.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3, 5126, ",\"min\":[0,0,0],\"max\":[1,1,0]");
  return w.gltf(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]},{\"primitives\":[{\"attributes\":"
      "{"
      "\"POSITION\":4}}]}],\"cameras\":[{\"type\":"
      "\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":0.1}}]," +
      nodes);
}

// The largest distance between vertices of the same place in both.
double difference(const Scene& a, const Scene& b) {
  REQUIRE(a.positions.count == b.positions.count);
  double most = 0;
  for (std::uint32_t v = 0; v < a.positions.count; ++v)
    most = std::max(most, length(to_double(a.positions[v]) - to_double(b.positions[v])));
  return most;
}

// In the scene's axes: `turned` where the file's Z axis points up.
void check_origin(const Scene& s, bool turned = false) {
  REQUIRE(s.origin.count == 1);
  CHECK(s.origin[0].x == 431250.37);
  CHECK((turned ? -s.origin[0].z : s.origin[0].y) == 120.5);
  CHECK((turned ? s.origin[0].y : s.origin[0].z) == 5411875.62);
}

}  // namespace

// Goal: HARDCASES row 69: far from the origin, a model has the shape that it has there. Method: a grid with details of
// a thousandth in OBJ, PLY and glTF, at UTM coordinates and at the origin; the offset is said and kept in a .pray file.
TEST_CASE("hard_69_models_far_from_the_origin_keep_their_shape") {
  count_assertions("the model at the origin");
  TemporaryFolder folder;
  const Offset zero = {"0", "0", "0"};
  const struct {
    const char* name;
    std::string near, far;
  } kModels[] = {{"a.obj", obj(zero), obj(kUtm)},
                 {"a.ply", ply(zero, "double"), ply(kUtm, "double")},
                 {"text.ply", ply(zero, "float"), ply(kUtm, "float")}};
  for (const auto& model : kModels) {
    CAPTURE(model.name);
    ImportedScene near = load(folder.write(model.name, model.near));
    CHECK(near.scene.origin.count == 0);
    CHECK(!contains(near.warning, "origin"));
    ImportedScene far = load(folder.write(model.name, model.far));
    check_origin(far.scene, contains(model.name, "ply"));
    CHECK(contains(far.warning, "far from the origin"));
    CHECK(contains(far.warning, "5411875.6"));
    CHECK(difference(far.scene, near.scene) <= 5e-7);  // an ulp
    BakedFile file = bake(far.scene);
    Scene opened;
    REQUIRE(baked_open(file.data(), file.size(), &opened).ok);
    CHECK(opened.origin[0].z == far.scene.origin[0].z);
  }
}

// Goal: HARDCASES row 69 for glTF: bit-equal to the node at the origin where its translation is the offset, also below
// other nodes; a camera beside it moves along. Method: positions.
TEST_CASE("hard_69_gltf_far_from_the_origin_is_bit_equal") {
  count_assertions("bit-equal");
  TemporaryFolder folder;
  ImportedScene near = load(folder.write("near.gltf", gltf("\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]")));
  for (const char* nodes :
       {"\"nodes\":[{\"mesh\":0,\"translation\":[431250.37,120.5,5411875.62]},{\"camera\":0,"
        "\"translation\":[431250.37,130.5,5411875.62]}],\"scenes\":[{\"nodes\":[0,1]}]",
        "\"nodes\":[{\"children\":[1,2],\"translation\":[431250.37,120.5,5411875.62]},{\"mesh\":0},{"
        "\"camera\":0,\"translation\":[0,10,0]}],\"scenes\":[{\"nodes\":[0]}]",
        "\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,431250.37,120.5,5411875.62,1]},"
        "{\"camera\":0,\"translation\":[431250.37,130.5,5411875.62]}],\"scenes\":[{\"nodes\":[0,1]}]"}) {
    CAPTURE(nodes);
    ImportedScene far = load(folder.write("far.gltf", gltf(nodes)));
    check_origin(far.scene);
    CHECK(difference(far.scene, near.scene) == 0);
    REQUIRE(far.scene.cameras.count == 1);
    CHECK(std::fabs(far.scene.cameras[0].eye.y - 10) < 1e-3f);
    CHECK(std::fabs(far.scene.cameras[0].eye.z) < 1e-3f);
  }
  ImportedScene moving = load(
      folder.write("moving.gltf",
                   gltf("\"nodes\":[{\"mesh\":0,\"translation\":[431250.37,120.5,5411875.62]}],\"scenes\":[{\"nodes\":"
                        "[0]}],\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3}],\"channels\":[{\"sampler\":0,"
                        "\"target\":{\"node\":0,\"path\":\"translation\"}}]}]")));
  check_origin(moving.scene);
  CHECK(std::fabs(moving.scene.key_values[0] - 0.13f) < 1e-3f);
  CHECK(moving.scene.key_values[3] - moving.scene.key_values[0] == 1);
}

// Goal: HARDCASES row 69 with a stray: a vertex or a small part left at the origin does not keep the rest from it, and
// what is exact as it is stays so. Method: the grid, one more triangle at the origin; in OBJ, PLY and below glTF's
// nodes; then the grid at whole numbers, which floats hold, with one.
TEST_CASE("hard_69_a_stray_part_at_the_origin_does_not_bend_a_far_model") {
  count_assertions("the model at the origin");
  TemporaryFolder folder;
  const Offset zero = {"0", "0", "0"};
  const std::string stray = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
  auto with_one = [](std::string text) {  // at the end of the vertices, used by no face
    text.replace(text.find("vertex 1681"), 11, "vertex 1682");
    return text.insert(text.find("\n3 0 1 41"), "\n0 0 0");
  };
  const struct {
    const char* name;
    std::string near, far;
  } kModels[] = {{"a.obj", obj(zero), obj(kUtm) + stray},
                 {"a.ply", ply(zero, "double"), with_one(ply(kUtm, "double"))}};
  for (const auto& model : kModels) {
    CAPTURE(model.name);
    const ImportedScene near = load(folder.write(model.name, model.near)),
                        far = load(folder.write(model.name, model.far));
    REQUIRE(far.scene.origin.count == 1);
    CHECK(contains(far.warning, "far from the origin"));
    double most = 0;
    for (std::uint32_t v = 0; v < near.scene.positions.count; ++v) {
      const Vec3d moved = to_double(far.scene.positions[v] - far.scene.positions[0]);
      most = std::max(most, length(moved - to_double(near.scene.positions[v] - near.scene.positions[0])));
    }
    CHECK(most <= 2e-6);
  }
  const ImportedScene nodes = load(folder.write(
      "a.gltf", gltf("\"nodes\":[{\"mesh\":0,\"translation\":[431250.37,120.5,5411875.62]},{\"mesh\":1}],\"scenes\":[{"
                     "\"nodes\":[0,1]}]")));
  check_origin(nodes.scene);
  std::string whole = stray;
  for (int i = 0; i < 900; ++i)
    whole +=
        "v " + std::to_string(5411875 + i % 30) + " " + std::to_string(i % 7) + " " + std::to_string(i / 30) + "\n";
  for (int i = 0; i < 869; ++i)
    if (i % 30 < 29)
      whole += "f " + std::to_string(i + 4) + " " + std::to_string(i + 5) + " " + std::to_string(i + 34) + "\n";
  CHECK(load(folder.write("whole.obj", whole)).scene.origin.empty());
}

// Goal: what assimp reads has floats, and far from the origin a message says how coarse they are. Method: the grid as
// OFF, whose places differ from those at the origin by no more than it says, and by half as much somewhere.
TEST_CASE("models_read_as_floats_tell_how_coarse_they_are_far_away") {
  if (!contains(import_formats(), " off")) {
    std::printf("skipped: built without assimp\n");
    return;
  }
  TemporaryFolder folder;
  auto off = [&](const Offset& o) {
    const std::vector<int> points = grid(), corners = faces();
    std::string text = "OFF\n" + std::to_string(points.size() / 3) + " " + std::to_string(corners.size() / 3) + " 0\n";
    for (std::size_t i = 0; i < points.size(); i += 3)
      text += decimal(o.x, points[i]) + " " + decimal(o.y, points[i + 1]) + " " + decimal(o.z, points[i + 2]) + "\n";
    for (std::size_t i = 0; i < corners.size(); i += 3)
      text += "3 " + std::to_string(corners[i]) + " " + std::to_string(corners[i + 1]) + " " +
              std::to_string(corners[i + 2]) + "\n";
    return load(folder.write("a.off", text));
  };
  const ImportedScene near = off({"0", "0", "0"}), far = off(kUtm);
  CHECK(!contains(near.warning, "rounded"));
  CHECK_MESSAGE(contains(far.warning, "rounded by up to 0.25; OBJ and PLY keep more digits"), far.warning);
  REQUIRE(far.scene.origin.count == 1);
  REQUIRE(far.scene.triangles.count == near.scene.triangles.count);
  double most = 0;  // of an edge, which has two ends
  for (std::uint32_t t = 0; t < near.scene.triangles.count; ++t)
    for (int k = 1; k < 3; ++k) {
      auto edge = [&](const Scene& s) {
        return to_double(s.positions[s.triangles[t].vertex(k)] - s.positions[s.triangles[t].vertex(0)]);
      };
      most = std::max(most, static_cast<double>(max_component(abs(to_float(edge(far.scene) - edge(near.scene))))));
    }
  CHECK(most <= .5);
  CHECK(most > .1);
}

// Goal: ordinary models keep their bits: only an offset that bends edges moves them. Method: a grid near the origin,
// and one 20 times its size away.
TEST_CASE("models_not_far_from_the_origin_stay_where_they_are") {
  TemporaryFolder folder;
  for (const Offset& o : {Offset{"0", "0", "0"}, Offset{"200", "0", "30"}}) {
    ImportedScene s = load(folder.write("a.obj", obj(o)));
    CHECK(s.scene.origin.count == 0);
    CHECK(s.scene.positions[0].x == static_cast<float>(std::strtod(o.x, nullptr) - 5));
  }
  ExactBox box;
  extend(&box, {1e6, 0, 0}), extend(&box, {1e6 + 1, 1, 1});
  CHECK(is_far(box, 100));
  extend(&box, {0, 0, 0});
  CHECK(!is_far(box, 100));
  CHECK(!is_far(ExactBox(), 0));
}
