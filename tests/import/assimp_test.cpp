// Formats read by assimp, if built in.
#include <cstring>

#include "import/import_testing.h"

using namespace pocketray;

static bool reads(const char* ending) {
  if (contains(" " + import_formats() + " ", std::string(" ") + ending + " ")) return true;
  std::printf("skipped: this build does not read .%s\n", ending);
  return false;
}

// Goal: faces without corners are refused by name. Method: COLLADA's list of polygons.
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
