// OBJ and MTL, written here, and what the samples show.
#include <algorithm>
#include <cmath>
#include <vector>

#include "brdf/brdf_list.h"
#include "import/import_testing.h"

using namespace pocketray;

namespace {

const char* const kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

// A quad of one material, whose MTL is given.
ImportedScene load_material(const std::string& mtl) {
  TemporaryFolder folder;
  folder.write("m.mtl", "newmtl m\n" + mtl);
  return load(folder.write("a.obj", std::string("mtllib m.mtl\n") + kQuad + "usemtl m\nf 1/1 2/2 3/3 4/4\n"));
}
const Material& first(const ImportedScene& imported) { return imported.scene.materials[0]; }

// An uncompressed 24-bit TGA of one row, pixels from the left as (r, g, b).
std::string tga(const std::vector<std::uint8_t>& rgb) {
  std::string file(18, '\0');
  file[2] = 2, file[12] = static_cast<char>(rgb.size() / 3), file[14] = 1, file[16] = 24, file[17] = 0x20;
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    for (std::size_t c = 3; c-- > 0;) file += static_cast<char>(rgb[i + c]);
  return file;
}

}  // namespace

// Goal: MTL's illumination models become the lobes obj_material.cpp states.
TEST_CASE("obj_illumination_models_map_to_our_lobes") {
  Material phong = first(load_material("Kd 0.5 0.25 0.125\nKs 0.3 0.2 0.1\nNs 40\nillum 2\n"));
  CHECK(phong.diffuse == Vec3{0.5f, 0.25f, 0.125f});
  CHECK(phong.specular == Vec3{0.3f, 0.2f, 0.1f});
  CHECK(phong.exponent == 40);
  CHECK(is_zero(phong.mirror));
  Material matt = first(load_material("Kd 0.5 0.5 0.5\nKs 0.3 0.2 0.1\nillum 1\n"));
  CHECK(is_zero(matt.specular));
  for (const char* illum : {"3", "5"}) {
    Material mirror = first(load_material(std::string("Kd 0 0 0\nKs 0.9 0.8 0.7\nillum ") + illum + "\n"));
    CHECK(mirror.mirror == Vec3{0.9f, 0.8f, 0.7f});
    CHECK(is_zero(mirror.specular));
  }
  for (const char* illum : {"6", "7"}) {
    Material glass = first(load_material(std::string("Tf 0.5 1 0.25\nNi 1.5\nillum ") + illum + "\n"));
    CHECK(glass.transmission == Vec3{0.5f, 1, 0.25f});
    CHECK(glass.ior == 1.5f);
    CHECK(glass.thin == 0);
  }
  for (const char* illum : {"4", "9"}) {  // as Maya writes them for opaque materials
    Material opaque =
        first(load_material(std::string("Kd 0.5 0.25 0.125\nKs 0.3 0.2 0.1\nNs 40\nTf 1 1 1\nillum ") + illum + "\n"));
    CHECK((is_zero(opaque.transmission) && opaque.opacity == 1));
    CHECK((opaque.diffuse == Vec3{0.5f, 0.25f, 0.125f} && opaque.exponent == 40));
    CHECK(first(load_material(std::string("d 0.5\nillum ") + illum + "\n")).opacity == 0.5f);
  }
  CHECK(is_zero(first(load_material("Tf 1 1 1\nillum 2\n")).transmission));
  CHECK(first(load_material("illum 7\n")).transmission == Vec3{1, 1, 1});
}

// Goal: MTL's extension for physically based rendering gives glTF's material, and `aniso` a grain: of that material, or
// of Ward's lobe in Phong's place; glass has none. Method: the formulas that obj_material.cpp states.
TEST_CASE("obj_physically_based_materials_and_grains") {
  const Material metal = first(load_material("Kd 0.8 0.4 0.2\nPr 0.5\nPm 1\nNs 40\nKs 1 1 1\nillum 3\n"));
  CHECK(metal.brdf == kGgx);
  CHECK((metal.specular == Vec3{0.8f, 0.4f, 0.2f} && is_zero(metal.diffuse)));
  CHECK((metal.roughness == 0.25f && metal.grazing == 1));
  const Material plastic = first(load_material("Kd 0.8 0.4 0.2\nPr 1\nNi 1.5\nillum 2\n"));
  CHECK(plastic.specular.x == doctest::Approx(0.04));
  ImportedScene brushed = load_material("Kd 0.1 0.1 0.1\nKs 0.3 0.2 0.1\nNs 48\nillum 2\naniso 0.5\nanisor 1.25\n");
  CHECK(first(brushed).brdf == kWard);
  // As high as the Phong lobe of that exponent, straight on.
  const Material phong = first(load_material("Kd 0.1 0.1 0.1\nKs 0.3 0.2 0.1\nNs 48\nillum 2\n"));
  const Vec3 n = {0, 0, 1}, none = {0, 0, 0};
  CHECK(kWardBrdf.value(first(brushed), {1, 1, 1}, none, {n, none}, n, n).x ==
        doctest::Approx(kPhongBrdf.value(phong, {1, 1, 1}, none, {n, none}, n, n).x).epsilon(1e-4));
  REQUIRE(brushed.scene.grains.count == 1);
  CHECK(brushed.scene.uvs.count == 4);
  CHECK(std::fabs(brushed.scene.grains[0].direction.x) < 1e-6f);
  CHECK(brushed.scene.grains[0].direction.y == doctest::Approx(0.5));
  brushed = load_material("Kd 0.8 0.4 0.2\nPr 0.5\nPm 1\naniso 2\nsheen 1\nPs 0.5\n");
  CHECK((first(brushed).brdf == kGgx && brushed.scene.grains.count == 1));
  CHECK(brushed.scene.grains[0].direction.x == 1);
  CHECK(brushed.warning.find("sheen") != std::string::npos);
  const ImportedScene glass = load_material("Kd 0.5 0.5 0.5\naniso 0.5\nillum 7\n");
  CHECK((glass.scene.grains.count == 0 && glass.warning.find("aniso of glass") != std::string::npos));
  CHECK(load_material("Kd 0.5 0.5 0.5\naniso 0.5\nillum 1\n").scene.grains.count == 0);
}

// Goal: `Pc` and `Pcr` are a clear coat over any material, glass too; none without strength.
TEST_CASE("obj_clear_coats_are_read") {
  for (const char* base : {"Kd 1 0 0\nillum 1\n", "Kd 1 0 0\nKs 1 1 1\nNs 9\nillum 2\n", "Pr 0.5\n", "illum 7\n"}) {
    const ImportedScene imported = load_material(std::string(base) + "Pc 0.5\nPcr 0.25\n");
    CAPTURE(std::string(base));
    CHECK(imported.warning.empty());
    REQUIRE(imported.scene.clear_coats.count == 1);
    const ClearCoat& coat = imported.scene.clear_coats[0];
    CHECK((coat.strength == 0.5f && coat.roughness == 0.25f && coat.roughness_low == 0.25f));
  }
  CHECK(load_material("Kd 1 0 0\nPcr 0.25\n").scene.clear_coats.empty());
  CHECK(load_material("Kd 1 0 0\nPc 9\nPcr -1\n").scene.clear_coats[0].strength == 1);
}

// Goal: emission and both spellings of opacity.
TEST_CASE("obj_emission_and_opacity") {
  CHECK(first(load_material("Ke 17 12 4\n")).emission == Vec3{17, 12, 4});
  CHECK(first(load_material("d 0.25\n")).opacity == 0.25f);
  CHECK(first(load_material("Tr 0.25\n")).opacity == 0.75f);
  CHECK(first(load_material("d 0.25\n")).alpha_mode == AlphaMode::blend);
  CHECK(first(load_material("d 1\n")).alpha_mode == AlphaMode::opaque);
}

// Goal: textures, their wrap and offset options, and map_d as alpha. Method: one-row TGA files; v runs upward in OBJ.
TEST_CASE("obj_textures_and_their_options") {
  TemporaryFolder folder;
  folder.write("color.tga", tga({255, 0, 0, 0, 255, 0}));
  folder.write("mask.tga", tga({0, 0, 0, 255, 255, 255}));
  folder.write("m.mtl",
               "newmtl m\nmap_Kd -clamp on -o 0.25 0.125 0 -s 2 4 1 color.tga\nmap_d -o 0.25 0.125 -s 2 4 "
               "mask.tga\nmap_bump bump.png\n");
  ImportedScene imported =
      load(folder.write("a.obj", std::string("mtllib m.mtl\n") + kQuad + "usemtl m\nf 1/1 2/2 3/3 4/4\n"));
  const Scene& s = imported.scene;
  REQUIRE(s.textures.count == 1);
  REQUIRE(s.texels.count == 2 + 1);  // and the level of one texel
  const std::uint8_t* texels = reinterpret_cast<const std::uint8_t*>(s.texels.data);
  CHECK((texels[0] == 255 && texels[1] == 0 && texels[3] == 0));
  CHECK((texels[4] == 0 && texels[5] == 255 && texels[7] == 255));
  CHECK(s.textures[0].wrap_u == Wrap::clamp);
  CHECK(s.materials[0].alpha_mode == AlphaMode::mask);
  CHECK(imported.warning == "not used: bump and normal maps");
  // Corner (0, 0) of OBJ: u = 0.25, v = 0.125 upward, so 0.875 downward.
  const TextureUse& use = s.materials[0].diffuse_texture;
  Vec2 uv = s.uvs[s.triangles[0].vertex(0)];
  CHECK(uv.y == 1);
  CHECK(use.m[0][0] * uv.x + use.m[0][1] * uv.y + use.m[0][2] == 0.25f);
  CHECK(use.m[1][0] * uv.x + use.m[1][1] * uv.y + use.m[1][2] == doctest::Approx(0.875));
}

// Goal: what is missing is a warning, not an error; what lies outside the folder is not touched.
TEST_CASE("obj_missing_and_foreign_files_are_remarks") {
  TemporaryFolder folder;
  std::string body = std::string(kQuad) + "usemtl gone\nf 1 2 3\n";
  ImportedScene no_mtl = load(folder.write("a.obj", "mtllib gone.mtl\n" + body));
  CHECK(no_mtl.scene.triangles.count == 1);
  CHECK(contains(no_mtl.warning, "gone.mtl"));
  ImportedScene foreign = load(folder.write("b.obj", "mtllib ../../etc/passwd\n" + body));
  CHECK(contains(foreign.warning, "beside the scene"));
  ImportedScene no_image = load_material("map_Kd gone.png\n");
  CHECK(contains(no_image.warning, "gone.png"));
  CHECK(no_image.scene.textures.count == 0);
  ImportedScene no_normal = load(folder.write("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/2 3/3/3\n"));
  CHECK(contains(no_normal.warning, "missing"));
}

// Goal: polygons become triangles that cover them; negative indices count back; a bad index is refused.
TEST_CASE("obj_polygons_and_indices") {
  TemporaryFolder folder;
  ImportedScene hexagon = load(folder.write("a.obj",
                                            "v 1 0 0\nv 0.5 0.8660254 0\nv -0.5 0.8660254 0\nv -1 0 0\nv -0.5 "
                                            "-0.8660254 0\nv 0.5 -0.8660254 0\nf -6 -5 -4 -3 -2 -1\n"));
  CHECK(hexagon.scene.triangles.count == 4);
  CHECK(hexagon.scene.normals.empty());  // flat: the geometric normals do
  CHECK(surface_area(hexagon.scene) == doctest::Approx(1.5 * std::sqrt(3.0)));
  ImportedScene notch = load(folder.write("b.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\nf 1 2 3 4 5\n"));
  CHECK(surface_area(notch.scene) == doctest::Approx(2.5));
  CHECK(contains(load_error(folder.write("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")), "vertex 9 of 3"));
}

// Goal: McGuire's Cornell boxes light by their emissive material, mirror by illum 5, refract by illum 7.
TEST_CASE("obj_sample_cornell_boxes_have_their_materials") {
  auto count = [](const ImportedScene& imported, auto test) {
    return std::count_if(imported.scene.materials.begin(), imported.scene.materials.end(), test);
  };
  auto emits = [](const Material& m) { return m.emission == Vec3{17, 12, 4}; };
  std::string path;
  if (have(path = shared_scene("cornell/mcguire/CornellBox-Original.obj"))) {
    ImportedScene imported = load(path);
    CHECK(count(imported, emits) == 1);
    CHECK(imported.warning.empty());
  }
  if (have(path = shared_scene("cornell/mcguire/CornellBox-Sphere.obj"))) {
    ImportedScene imported = load(path);
    CHECK(count(imported, [](const Material& m) { return m.mirror.x == 0.95f; }) == 1);
    CHECK(count(imported, [](const Material& m) { return m.transmission.x > 0 && m.ior == 2.5f; }) == 1);
  }
}

// Goal: OBJ's less usual forms are read. Method: the same square in each; an error behind a continued line still names
// the right line.
TEST_CASE("obj_less_usual_forms") {
  TemporaryFolder folder;
  auto area = [&](const std::string& text) { return surface_area(load(folder.write("a.obj", text)).scene); };
  const std::string quad = kQuad, normal = "vn 0 0 1\n";
  for (const char* faces :
       {"f 1// 2// 3// 4//\n", "f 1/ 2/ 3/ 4/\n", "f 1/1/ 2/2/ 3/3/ 4/4/\n", "f 1/1/ 2/2/ 3/3/ 4/4/", "f 1 2 \\\n3 4\n",
        "f 1 2\\\r\n 3\\\n 4\r\n", "f 1// 2//\\\n 3// 4//\n", "f 1 2 3 4\\", "f 1 2 3 4 \\\n",
        "f 1/1/1 2//1 3/3/ 4//\n", "# a comment may end so \\\nf 1 2 3 4\n"}) {
    CAPTURE(std::string(faces));
    CHECK(area(quad + normal + faces) == doctest::Approx(1));
  }
  CHECK(area("v 0 \\\n0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") == doctest::Approx(0.5));
  CHECK(contains(load_error(folder.write("a.obj", "v 0 \\\n0 \\\n0\nv 1 0 0\nv 0 x 0\nf 1 2 3\n")), "line 5"));
  std::string marked = "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  CHECK(area(marked) == doctest::Approx(0.5));
}

// Goal: texts in UTF-16 are refused by that name. Method: both byte orders, with and without a byte order mark.
TEST_CASE("obj_in_utf_16_is_refused") {
  TemporaryFolder folder;
  for (bool big : {false, true})
    for (bool mark : {false, true}) {
      std::string wide = mark ? std::string(big ? "\xFE\xFF" : "\xFF\xFE") : "";
      for (char c : std::string(kQuad) + "f 1 2 3\n") wide += big ? std::string(1, '\0') + c : c + std::string(1, '\0');
      CHECK(contains(load_error(folder.write("a.obj", wide)), "UTF-16; save it as UTF-8"));
    }
}

// Goal: files whose names differ only in case are found, as where the model was made; the exact name wins.
TEST_CASE("obj_files_are_found_in_any_case") {
  TemporaryFolder folder;
  REQUIRE(mkdir((folder.path + "/Maps").c_str(), 0700) == 0);
  folder.write("M.MTL", "newmtl m\nmap_Kd maps\\Sp_LUK.TGA\n");
  folder.write("Maps/sp_luk.tga", tga({255, 0, 0}));
  std::string obj = folder.write("a.obj", std::string("mtllib m.mtl\n") + kQuad + "usemtl m\nf 1/1 2/2 3/3 4/4\n");
  auto red = [&] {
    ImportedScene imported = load(obj);
    CHECK(imported.warning.empty());
    REQUIRE(imported.scene.texels.count == 1);
    return imported.scene.texels[0] & 255;
  };
  CHECK(red() == 255);
  folder.write("Maps/Sp_luk.tga", tga({7, 0, 0}));
  CHECK(red() == 7);  // the first in byte order
  folder.write("Maps/Sp_LUK.TGA", tga({9, 0, 0}));
  CHECK(red() == 9);
  REQUIRE(rename((folder.path + "/Maps").c_str(), (folder.path + "/maps").c_str()) == 0);
  CHECK(red() == 9);
  REQUIRE(std::remove((folder.path + "/M.MTL").c_str()) == 0);
  CHECK(contains(load(obj).warning, "m.mtl"));
}

// Goal: spaces in the name of a material file need no escapes, as other programs write it. Method: one file or several
// in a line, with and without the file that the whole line names.
TEST_CASE("obj_material_files_may_have_spaces_in_their_names") {
  TemporaryFolder folder;
  const std::string rest = std::string(kQuad) + "usemtl m\nf 1 2 3 4\n";
  auto green = [&](const std::string& line) {
    ImportedScene imported = load(folder.write("a.obj", line + rest));
    CHECK(imported.warning.empty());
    return imported.scene.materials[0].diffuse.y;
  };
  folder.write("no", "newmtl m\nKd 0 0.25 0\n");
  CHECK(green("mtllib no such.mtl\n") == doctest::Approx(0.25));
  folder.write("no such.mtl", "newmtl m\nKd 0 0.5 0\n");
  CHECK(green("mtllib no such.mtl\n") == doctest::Approx(0.5));
  CHECK(green("mtllib   no such.mtl  \r\n") == doctest::Approx(0.5));
  CHECK(green("mtllib no\\ such.mtl\n") == doctest::Approx(0.5));
  CHECK(green("mtllib no\n") == doctest::Approx(0.25));
}
