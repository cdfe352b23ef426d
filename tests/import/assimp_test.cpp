// Formats read by assimp, if built in.
#include <cstring>
#include <initializer_list>

#include "import/import_testing.h"

using namespace pocketray;

static bool reads(const char* ending) {
  if (contains(" " + import_formats() + " ", std::string(" ") + ending + " ")) return true;
  std::printf("skipped: this build does not read .%s\n", ending);
  return false;
}

// Goal: PLY faces, vertex colours (display values, so sRGB) and normals arrive. Method: an ASCII file of a quad and a
// triangle.
TEST_CASE("assimp_ply_quads_and_vertex_colors") {
  if (!reads("ply")) return;
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\n"
      "property uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 188 0\n1 0 0 255 188 0\n1 1 0 255 188 0\n0 1 0 255 188 0\n2 0 0 255 188 0\n4 0 1 2 3\n3 1 4 2\n"));
  const Scene& s = imported.scene;
  CHECK(s.triangles.count == 3);
  CHECK(surface_area(s) == doctest::Approx(1.5));
  REQUIRE(s.colors.count == s.positions.count);
  CHECK(s.colors[0].r == 65535);
  CHECK(s.colors[0].g / 65535.0 == doctest::Approx(0.503).epsilon(0.01));
  CHECK(s.materials[0].diffuse == Vec3{0.8f, 0.8f, 0.8f});
  CHECK(is_zero(s.materials[0].specular));
}

// Goal: a PLY header that states more than the file holds is refused before allocating.
TEST_CASE("assimp_ply_header_that_lies_is_refused") {
  if (!reads("ply")) return;
  TemporaryFolder folder;
  for (const char* format : {"ascii", "binary_little_endian"}) {
    std::string error =
        load_error(folder.write("a.ply", std::string("ply\nformat ") + format +
                                             " 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
                                             "y\nproperty float z\nend_header\n0 0 0\n"));
    CHECK(contains(error, "states 4000000000"));
  }
}

namespace {

// A PLY file of four vertices; `faces` in text, or in bytes.
std::string ply_of_faces(const char* format, const char* count_type, const std::string& faces) {
  std::string file = std::string("ply\nformat ") + format +
                     " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
                     "property list " +
                     count_type + " int vertex_indices\nend_header\n";
  if (format[0] == 'a') return file + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces;
  const float corners[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  return file + std::string(reinterpret_cast<const char*>(corners), sizeof corners) + faces;
}
std::string words(std::initializer_list<std::int32_t> values) {
  return std::string(reinterpret_cast<const char*>(values.begin()), 4 * values.size());
}

}  // namespace

// Goal: faces with no corners, a negative number, too many, or missing vertices are refused by name before they reach
// assimp, parts of which would crash. Method: such lists in text and binary, after a valid face; valid lists are read.
TEST_CASE("assimp_ply_faces_that_lie_are_refused") {
  if (!reads("ply")) return;
  TemporaryFolder folder;
  auto error = [&](const char* format, const char* type, const std::string& faces) {
    return load_error(folder.write("a.ply", ply_of_faces(format, type, faces)));
  };
  CHECK(contains(error("ascii", "uchar", "3 0 1 2\n0\n"), "face 1 of the PLY file has no corners"));
  CHECK(contains(error("ascii", "uchar", "0\n3 0 1 2\n"), "face 0 of the PLY file has no corners"));
  CHECK(contains(error("ascii", "int", "3 0 1 2\n-3 0 1 2\n"), "list 1 of the PLY file has -3 entries"));
  CHECK(contains(error("ascii", "int", "3 0 1 2\n100000 0 1 2\n"), "has 100000 entries"));
  CHECK(contains(error("ascii", "uchar", "3 0 1 2\n3 0 -3 2\n"), "face 1 of the PLY file uses vertex -3"));
  CHECK(contains(error("ascii", "uchar", "3 0 1 2\n3 0 4 2\n"), "uses vertex 4 of 4"));
  const char* little = "binary_little_endian";
  CHECK(contains(error(little, "int", words({3, 0, 1, 2, 0})), "face 1 of the PLY file has no corners"));
  CHECK(contains(error(little, "int", words({3, 0, 1, 2, -3, 0, 1, 2})), "list 1 of the PLY file has -3 entries"));
  CHECK(contains(error(little, "uint", words({3, 0, 1, 2, -3, 0, 1, 2})), "has 4.29497e+09 entries"));
  CHECK(contains(error("binary_big_endian", "int", words({0x03000000, 0, 1 << 24, 2 << 24, 0})), "has no corners"));
  ImportedScene imported = load(folder.write("a.ply", ply_of_faces(little, "int", words({3, 0, 1, 2, 3, 0, 2, 3}))));
  CHECK(imported.scene.triangles.count == 2);
}

// Goal: faces without corners are also refused in formats that are not pre-checked. Method: COLLADA's list of polygons.
TEST_CASE("assimp_faces_without_corners_are_refused") {
  if (!reads("dae")) return;
  TemporaryFolder folder;
  std::string error = load_error(folder.write("a.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3 0</vcount><p>0 1 2</p></polylist></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)"));
  CHECK_MESSAGE(contains(error, "face 1 has no corners"), error);
}

// Goal: an STL box is smoothed by the crease angle, not faceted by the file's normals: it is flat, so it has none.
TEST_CASE("assimp_stl_triangles") {
  if (!reads("stl")) return;
  TemporaryFolder folder;
  std::string file(80, ' ');
  std::uint32_t count = 2;
  float triangles[2][12] = {{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 0}};
  file.append(reinterpret_cast<char*>(&count), 4);
  for (auto& triangle : triangles) {
    file.append(reinterpret_cast<char*>(triangle), 48);
    file.append(2, '\0');
  }
  ImportedScene imported = load(folder.write("a.stl", file));
  CHECK(imported.scene.triangles.count == 2);
  CHECK(surface_area(imported.scene) == doctest::Approx(1));
  CHECK(imported.scene.normals.empty());
}

// Goal: COLLADA's node transforms, material, light and camera. Method: a triangle under a translated node.
TEST_CASE("assimp_collada_transforms_materials_lights_and_cameras") {
  if (!reads("dae")) return;
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write("a.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="cam" name="cam"><optics><technique_common><perspective><xfov>60</xfov><aspect_ratio>1</aspect_ratio>
<znear>0.1</znear><zfar>100</zfar></perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="lamp" name="lamp"><technique_common><point><color>1 0.5 0.25</color></point></technique_common></light></library_lights>
<library_effects><effect id="fx"><profile_COMMON><technique sid="t"><phong><emission><color>0 0 0 1</color></emission>
<diffuse><color>0.5 0.25 0.125 1</color></diffuse><specular><color>0.25 0.25 0.25 1</color></specular>
<shininess><float>20</float></shininess></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="mat" name="mat"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>5 6 7</translate><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="m" target="#mat"/></technique_common></bind_material></instance_geometry></node>
<node id="ln" name="lamp"><translate>0 9 0</translate><instance_light url="#lamp"/></node>
<node id="cn" name="cam"><translate>0 0 20</translate><instance_camera url="#cam"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)"));
  const Scene& s = imported.scene;
  REQUIRE(s.triangles.count == 1);
  CHECK(bounds(s).low == Vec3{5, 6, 7});
  const Material& m = s.materials[s.triangles[0].material()];
  CHECK(m.diffuse == Vec3{0.5f, 0.25f, 0.125f});
  CHECK(m.specular == Vec3{0.25f, 0.25f, 0.25f});
  CHECK(m.exponent == 20);
  REQUIRE(s.lights.count == 1);
  CHECK(s.lights[0].position == Vec3{0, 9, 0});
  CHECK(s.lights[0].intensity == Vec3{1, 0.5f, 0.25f});
  REQUIRE(s.cameras.count == 1);
  CHECK(s.cameras[0].eye == Vec3{0, 0, 20});
  CHECK(s.cameras[0].target.z < 20);
  CHECK(s.cameras[0].vertical_fov == doctest::Approx(60 * 3.14159265 / 180).epsilon(1e-4));
}
