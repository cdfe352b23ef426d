// HARDCASES row 8 at import: a number in a scene file that is invalid, not finite, beyond float or beyond the limit of
// coordinates is refused with one line that names its place. Numbers of vertices are refused only with `strict`;
// without, the faces that use them are left out. Method, throughout: a valid file, then the same with one number
// replaced.
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "scene/baked.h"

using namespace pocketray;

namespace {

const std::string kTexel =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJg"
    "gg==";
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

void check_refused(const std::string& path, const std::string& place) {
  ImportOptions options;
  options.strict = true;
  std::string error = load_error(path, options);
  CHECK_MESSAGE(contains(error, path + ":"), error);
  CHECK_MESSAGE(contains(error, place), error);
  CHECK(error.find('\n') == std::string::npos);
  bool mends = contains(error, "mend") || contains(error, "export") || contains(error, "scale the model down");
  CHECK_MESSAGE(mends, error);
}

}  // namespace

// Goal: OBJ lines. The library alone reads "nan" as 0.
TEST_CASE("hard_08_obj_numbers_that_are_not_finite_are_refused_by_line") {
  TemporaryFolder folder;
  const std::string obj =
      "# a triangle\r\nv 0 0 0\r\nv 1 0 0 # corner\r\nv 0 1 0 0.5 0.5 0.5\r\nvt 0.25 .5\nvn 0 0 1e0\nf 1/1/1 2/1/1 "
      "3/1/1\n";
  CHECK(load(folder.write("a.obj", obj)).scene.triangles.count == 1);
  const char* const bad[] = {
      "nan",   "-NaN", "inf", "-Infinity", "1e39", "1e400", "abc", "0x1p4",
      "1.2.3", "1,5",  "-",   ".",         "1e",   "--1",   "1e+", "99999999999999999999999999999999999999999999"};
  for (const char* number : bad) {
    CAPTURE(std::string(number));
    std::string n = number;
    check_refused(folder.write("a.obj", replaced(obj, "v 0 0 0", "v 0 " + n + " 0")), "line 2: '" + n.substr(0, 40));
    check_refused(folder.write("a.obj", replaced(obj, "v 1 0 0", "\t v 1 0\t" + n)), "line 3: '" + n.substr(0, 40));
    check_refused(folder.write("a.obj", replaced(obj, "vt 0.25", "vt " + n)), "line 5: '" + n.substr(0, 40));
    check_refused(folder.write("a.obj", replaced(obj, "vn 0 0 1e0", "vn 0 0 " + n)), "line 6: '" + n.substr(0, 40));
  }
  check_refused(folder.write("a.obj", replaced(obj, "0.5 0.5 0.5", "0.5 nan 0.5")), "line 4: 'nan'");
  check_refused(folder.write("a.obj", replaced(obj, "v 1 0 0", "v 1.0001e18 0 0")), "line 3: '1.0001e18'");
  check_refused(folder.write("a.obj", replaced(obj, "v 1 0 0", "v 1000000000000000001000000000000 0 0")), "line 3");
  const char* const good[] = {"1",
                              "+1.",
                              ".5",
                              "-.5E-3",
                              "1e18",
                              "999999999999999999",
                              "1000000000000000000",
                              "1e-400",
                              "0000000000000000000000001",
                              "1.00000000000000000000000000000000000000000000000000001"};
  for (const char* number : good) {
    CAPTURE(std::string(number));
    load(folder.write("a.obj", replaced(obj, "v 1 0 0", std::string("v ") + number + " 0 0")));
  }
  load(folder.write("a.obj", replaced(obj, "vn 0 0 1e0", "vn 0 0 1e30")));  // a direction: HARDCASES row 30
}

// Goal: without `strict`, the faces of a vertex that is not finite are left out and counted, and the others are shown;
// a word that is no number is still refused. Method: two triangles and a polygon, one vertex spoilt at a time.
TEST_CASE("hard_08_faces_with_vertices_that_are_not_finite_are_left_out") {
  TemporaryFolder folder;
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nvn 0 0 1\nf 1 2 3\nf 4//1 5//1 6//1 7//1\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n5 0 0\n6 0 0\n6 1 0\n5 1 0\n3 0 1 2\n"
      "4 3 4 5 6\n";
  for (const char* number : {"nan", "-NaN", "inf", "1e39", "2e18"})
    for (const auto& file : {std::make_pair("a.obj", obj), std::make_pair("a.ply", ply)}) {
      CAPTURE(std::string(number));
      ImportedScene few = load(folder.write(file.first, replaced(file.second, "6 1 0", std::string("6 1 ") + number)));
      CHECK(few.scene.triangles.count == 1);
      CHECK(contains(few.warning, "1 face is left out, as a vertex is not finite"));
      for (const Vec3& p : few.scene.positions) CHECK(is_finite(p));
      CHECK(load(folder.write(file.first, replaced(file.second, "0 1 0", std::string(number) + " 1 0")))
                .scene.triangles.count == 2);
    }
  const ImportedScene normal = load(folder.write("a.obj", replaced(obj, "vn 0 0 1", "vn 0 nan 1")));
  CHECK(normal.scene.triangles.count == 3);
  for (const Vec3& n : normal.scene.normals) CHECK(is_finite(n));
  CHECK(contains(load_error(folder.write("a.obj", replaced(obj, "6 1 0", "6 1 x"))), "line 6: 'x'"));
  CHECK(contains(load_error(folder.write("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")),
                 "(1 face is left out, as a vertex is not finite"));
}

// Goal: likewise for glTF, dense and sparse, static, morphed and skinned. A normal, a texture coordinate, a colour or a
// weight that is not finite costs no face. Method: two triangles, the second by indices; each attribute spoilt at the
// last vertex of the second.
TEST_CASE("hard_08_gltf_faces_with_vertices_that_are_not_finite_are_left_out") {
  TemporaryFolder folder;
  struct Attribute {
    const char* name;
    std::vector<float> values;
    const char* type;
    int components;
    std::uint32_t triangles_left;
  };
  const std::vector<float> around = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  const std::vector<float> weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  const std::vector<Attribute> sound = {
      {"POSITION", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 0, 0}, "VEC3", 3, 1},
      {"NORMAL", around, "VEC3", 3, 2},
      {"TEXCOORD_0", {0, 0, 1, 0, 0, 1, 1, 1, 2, 0}, "VEC2", 2, 2},
      {"COLOR_0", {1, 1, 1, 1, .5f, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, "VEC3", 3, 2},
      {"TANGENT", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", 4, 2},
      {"WEIGHTS_0", weights, "VEC4", 4, 2},
      {"morph target", around, "VEC3", 3, 1},
  };
  auto write = [&](const std::vector<Attribute>& data, const std::string& node) {
    GltfWriter w;
    std::string attributes;
    for (const Attribute& a : data) w.add(a.values, a.type, a.components, 5126);
    for (std::size_t i = 0; i + 1 < data.size(); ++i)
      attributes += "\"" + std::string(data[i].name) + "\":" + std::to_string(i) + ",";
    const int joints = w.add(std::vector<std::uint8_t>(20, 0), "VEC4", 4, 5121), faces = w.indices({0, 1, 2, 1, 4, 3});
    return folder.write("a.glb",
                        w.glb("\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{" + attributes +
                              "\"JOINTS_0\":" + std::to_string(joints) + "},\"indices\":" + std::to_string(faces) +
                              ",\"targets\":[{\"POSITION\":6}],\"material\":0}]}],\"materials\":[{\"normalTexture\":{"
                              "\"index\":0}}],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"" +
                              kTexel + "\"}],\"skins\":[{\"joints\":[1]}],\"nodes\":[{\"mesh\":0" + node +
                              "},{}],\"scenes\":[{\"nodes\":[0,1]}]"));
  };
  for (const char* node : {"", ",\"skin\":0"}) {
    CAPTURE(std::string(node));
    const ImportedScene all = load(write(sound, node));
    CHECK(all.scene.triangles.count == 2);
    CHECK_FALSE(contains(all.warning, "left out"));
    for (std::size_t i = 0; i < sound.size(); ++i)
      for (float bad : {kNan, kInf, -kInf, 2e18f}) {
        CAPTURE(std::string(sound[i].name));
        CAPTURE(bad);
        std::vector<Attribute> data = sound;
        data[i].values[data[i].values.size() - 2] = bad;
        const ImportedScene few = load(write(data, node));
        CHECK(few.scene.triangles.count == sound[i].triangles_left);
        CHECK(contains(few.warning, "1 face is left out, as a vertex is not finite") == (sound[i].triangles_left == 1));
        CHECK(validate_scene(few.scene).ok);
      }
  }
}

// Goal: a vertex that its node takes out of range counts as one that is not finite, in glTF and by assimp. Method: one
// far vertex of two triangles, still and moved by an animation; two instances count the face twice.
TEST_CASE("hard_08_faces_that_a_node_takes_out_of_range_are_left_out") {
  TemporaryFolder folder;
  for (const char* animation : {"",
                                ",\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3}],\"channels\":[{"
                                "\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}]}]"}) {
    GltfWriter w;
    w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1e12f, 0});
    w.indices({0, 1, 2, 0, 1, 3});
    w.floats({0, 1});
    w.vec3s({0, 0, 0, 1, 0, 0});
    const ImportedScene few = load(folder.write(
        "a.glb", w.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"nodes\":[{"
                       "\"mesh\":0,\"scale\":[1,1e10,1]},{\"mesh\":0,\"scale\":[1,2e10,1]}],\"scenes\":[{\"nodes\":["
                       "0,1]}]" +
                       std::string(animation))));
    CHECK(few.scene.triangles.count == 2);
    CHECK(contains(few.warning, "2 faces are left out, as vertices are not finite"));
    CHECK(validate_scene(few.scene).ok);
  }
}

// Goal: MTL lines, and the numbers of its texture options.
TEST_CASE("hard_08_mtl_numbers_that_are_not_finite_are_refused_by_file_and_line") {
  TemporaryFolder folder;
  std::string path = folder.write("a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  const char* const keys[] = {"Ka 0 0 ",
                              "Kd ",
                              "Kd 1 1 ",
                              "Ks ",
                              "Tf 1 ",
                              "Ke ",
                              "Ns ",
                              "Ni ",
                              "Tr ",
                              "d ",
                              "Pr ",
                              "aniso ",
                              "illum ",
                              "Ka 1 1 1 ",
                              "map_Kd -o ",
                              "map_Kd -o 0.5 ",
                              "map_Kd -s 1 1 ",
                              "bump -bm "};
  for (const char* key : keys)
    for (const char* number : {"nan", "inf", "1e39"}) {
      CAPTURE(std::string(key));
      folder.write("m.mtl", std::string("newmtl m\n\n") + key + "1\n");
      load(path);
      folder.write("m.mtl", std::string("newmtl m\n\n") + key + number + "\n");
      check_refused(path, "m.mtl, line 3: '" + std::string(number));
    }
  folder.write("m.mtl", "newmtl m\nTr 0  illum 2\nmap_Kd -o 0.5 gone.png\nmap_Ks -boost 2 nan.png # nan\n");
  load(path);  // as in real files
}

// Goal: glTF's JSON: literals that JSON does not have, and numbers beyond float, wherever a number may stand.
TEST_CASE("hard_08_gltf_json_numbers_that_are_not_finite_are_refused_by_place") {
  TemporaryFolder folder;
  const std::string material =
      "{\"name\":\"paint\",\"emissiveFactor\":[0,0,1],\"alphaCutoff\":0.5,\"pbrMetallicRoughness\":{"
      "\"roughnessFactor\":1.0},"
      "\"extensions\":{\"KHR_materials_ior\":{\"ior\":1.5}}}";
  const std::string node =
      ",\"name\":\"lamp\",\"camera\":0,\"translation\":[0,2.5,0],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}"
      "}";
  const std::string rest =
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.75,\"znear\":0.1}}],\"extensions\":{"
      "\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"intensity\":3.5}]}}";
  const std::string text = triangle_gltf(material, rest, node);
  CHECK(load(folder.write("a.gltf", text)).scene.lights.count == 1);
  const char* const places[][2] = {
      {"[0,2.5", "/nodes/0/translation/1 ('lamp')"},
      {"\"alphaCutoff\":0.5", "/materials/0/alphaCutoff ('paint')"},
      {"\"roughnessFactor\":1.0", "/materials/0/pbrMetallicRoughness/roughnessFactor ('paint')"},
      {"\"ior\":1.5", "/materials/0/extensions/KHR_materials_ior/ior ('paint')"},
      {"\"yfov\":0.75", "/cameras/0/perspective/yfov"},
      {"\"intensity\":3.5", "/extensions/KHR_lights_punctual/lights/0/intensity"},
  };
  for (const auto& place : places)
    for (const char* number : {"NaN", "Infinity", "-Infinity", "nan", "1e39", "-1e39", "1e400"}) {
      CAPTURE(std::string(number));
      std::string field = place[0];
      std::string changed = field.substr(0, field.find_last_of(":,") + 1) + number;
      check_refused(folder.write("a.gltf", replaced(text, field, changed)), place[1]);
    }
  load(folder.write("a.gltf", replaced(text, "\"camera\":0", "\"camera\":0,\"extras\":{\"note\":1e39}")));
}

// Goal: glTF's accessors: geometry, skin, morph targets, animation, instances; dense and sparse.
TEST_CASE("hard_08_gltf_accessor_values_that_are_not_finite_are_refused_by_accessor") {
  TemporaryFolder folder;
  struct Data {
    std::vector<float> values;
    const char* type;
    int components;
    const char* what;
  };
  std::vector<float> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const std::vector<Data> sound = {
      {{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3, "POSITION"},
      {{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3, "NORMAL"},
      {{1, 1, 1, 0.5f, 1, 1, 1, 1, 1}, "VEC3", 3, "COLOR_0"},
      {{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4, "WEIGHTS_0"},
      {{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3, "a morph target"},
      {identity, "MAT4", 16, "inverse bind matrices"},
      {{0, 1}, "SCALAR", 1, "animation times"},
      {{0, 0, 0, 1, 2, 3}, "VEC3", 3, "animation values"},
      {{0, 1}, "SCALAR", 1, "animation values"},
      {{0, 0, 0, 1, 2, 3}, "VEC3", 3, "EXT_mesh_gpu_instancing"},
      {{0, 0, 1, 0, 0, 1}, "VEC2", 2, "TEXCOORD"},
  };
  const std::string document =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"COLOR_0\":2,\"WEIGHTS_0\":3,"
      "\"JOINTS_0\":"
      "11,\"TEXCOORD_0\":10},\"targets\":[{\"POSITION\":4}],\"material\":0}]}],\"materials\":[{"
      "\"pbrMetallicRoughness\":{"
      "\"baseColorTexture\":{\"index\":0}}}],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"" +
      kTexel +
      "\"}],\"skins\":[{\"joints\":[1],\"inverseBindMatrices\":5}],\"nodes\":[{\"mesh\":0,\"skin\":0},{},{\"mesh\":0,"
      "\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":9}}}}],\"animations\":[{"
      "\"samplers\":[{"
      "\"input\":6,\"output\":7},{\"input\":6,\"output\":8}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,"
      "\"path\":"
      "\"translation\"}},{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"weights\"}}]}],\"scenes\":[{\"nodes\":[0,1,2]"
      "}]";
  auto write = [&](const std::vector<Data>& data) {
    GltfWriter w;
    for (std::size_t i = 0; i < data.size(); ++i)
      w.add(data[i].values, data[i].type, data[i].components, 5126, ",\"name\":\"data " + std::to_string(i) + "\"");
    w.add(std::vector<std::uint8_t>(12, 0), "VEC4", 4, 5121);
    return folder.write("a.glb", w.glb(document));
  };
  const ImportedScene imported = load(write(sound));
  CHECK(imported.scene.channels.count == 2);
  CHECK(imported.scene.triangles.count == 3);
  for (std::size_t i = 0; i < sound.size(); ++i)
    for (float bad : {kNan, kInf, -kInf, 1.5e18f}) {
      if (bad == 1.5e18f && i == 1) continue;  // a normal: HARDCASES row 30
      CAPTURE(i);
      CAPTURE(bad);
      std::vector<Data> data = sound;
      data[i].values.back() = bad;
      std::size_t element = data[i].values.size() / static_cast<std::size_t>(data[i].components) - 1;
      check_refused(write(data), std::string(sound[i].what) + ": element " + std::to_string(element) + " of accessor " +
                                     std::to_string(i) + " 'data " + std::to_string(i) + "'");
    }
}

// Goal: a sparse accessor's values too; and a vertex that is finite until its node places it.
TEST_CASE("hard_08_gltf_sparse_values_and_placed_vertices_are_refused_by_name") {
  TemporaryFolder folder;
  for (float value : {0.5f, kNan}) {
    GltfWriter w;
    w.indices({2});
    w.vec3s({0, value, 0});
    w.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3, 5126,
          ",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5123},\"values\":{\"bufferView\":1}"
          "}");
    std::string path = folder.write("a.glb", w.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2}}]}],"
                                                   "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]"));
    if (std::isfinite(value))
      load(path);
    else
      check_refused(path, "POSITION: element 2 of accessor 2 is nan");
  }
  for (bool far : {false, true}) {
    GltfWriter w;
    w.vec3s({0, 0, 0, 1e12f, 0, 0, 0, 1e12f, 0});
    std::string path = folder.write(
        "a.glb", w.glb("\"meshes\":[{\"name\":\"sky\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{"
                       "\"mesh\":0,\"scale\":[1," +
                       std::string(far ? "1e10" : "1e2") + ",1]}],\"scenes\":[{\"nodes\":[0]}]"));
    if (far)
      check_refused(path, "mesh 0 'sky': a vertex is at (0, 1e+22, 0)");
    else
      load(path);
  }
}

// Goal: numbers of a PLY file, as text and as bytes.
TEST_CASE("hard_08_ply_numbers_that_are_not_finite_are_refused_by_name") {
  TemporaryFolder folder;
  const std::string header =
      " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
      "ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string text = "ply\nformat ascii" + header + "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 2\n3 0 1 2\n";
  CHECK(load(folder.write("a.ply", text)).scene.triangles.count == 1);
  for (const char* number : {"nan", "inf", "-inf", "1e39"}) {
    CAPTURE(std::string(number));
    check_refused(folder.write("a.ply", replaced(text, "\n1 0 0", std::string("\n1 0 ") + number)),
                  "position of vertex 1");
    check_refused(folder.write("a.ply", replaced(text, "0 2\n", std::string("0 ") + number + "\n")),
                  "normal of vertex 2");
  }
  check_refused(folder.write("a.ply", replaced(text, "\n1 0 0", "\n1 0 1.5e18")), "position of vertex 1");
  check_refused(folder.write("a.ply", replaced(text, "\n1 0 0", "\n1 0 x")), "'x' instead of a number");
  std::vector<float> vertices = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};
  auto binary = [&] {
    std::string file = "ply\nformat binary_little_endian" + header;
    file.append(reinterpret_cast<const char*>(vertices.data()), vertices.size() * sizeof(float));
    return folder.write("b.ply", file + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13));
  };
  load(binary());
  vertices[13] = kNan;
  check_refused(binary(), "position of vertex 2");
}

// Goal: formats that assimp reads: vertices, materials, nodes, lights, cameras.
TEST_CASE("hard_08_assimp_numbers_that_are_not_finite_are_refused_by_name") {
  if (!contains(import_formats(), " dae")) {
    std::printf("skipped: built without assimp\n");
    return;
  }
  TemporaryFolder folder;
  const std::string dae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="cam" name="cam"><optics><technique_common><perspective><xfov>60</xfov><aspect_ratio>1</aspect_ratio>
<znear>0.1</znear><zfar>100</zfar></perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="lamp" name="lamp"><technique_common><point><color>1 0.5 0.25</color></point></technique_common></light></library_lights>
<library_effects><effect id="fx"><profile_COMMON><technique sid="t"><phong>
<diffuse><color>0.5 0.25 0.125 1</color></diffuse><shininess><float>20</float></shininess></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="mat" name="paint"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 3 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>5 6 7</translate><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="m" target="#mat"/></technique_common></bind_material></instance_geometry></node>
<node id="ln" name="lamp"><translate>0 9 0</translate><instance_light url="#lamp"/></node>
<node id="cn" name="cam"><translate>0 0 20</translate><instance_camera url="#cam"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  load(folder.write("a.dae", dae));
  const char* const places[][3] = {
      {"0 3 0<", "0 nan 0<", "position of vertex 2"},       {"0.25 0.125 1", "0.25 inf 1", "material 'paint'"},
      {"<float>20<", "<float>nan<", "material 'paint'"},    {"5 6 7", "5 1e39 7", "node 'n': its transform"},
      {"0.5 0.25<", "nan 0.25<", "light 'ln': its colour"}, {"<xfov>60", "<xfov>inf", "camera 'cn': its field of view"},
  };
  for (const auto& place : places) check_refused(folder.write("a.dae", replaced(dae, place[0], place[1])), place[2]);
}
