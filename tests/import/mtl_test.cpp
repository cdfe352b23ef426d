// What programs write into MTL and OBJ files beyond their specification, and what they leave out.
#include <vector>

#include "import/import_testing.h"

using namespace pocketray;

namespace {

const char* const kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
const char* const kFace = "f 1/1 2/2 3/3 4/4\n";

// An uncompressed TGA of one row, pixels as (r, g, b, a).
std::string tga(const std::vector<std::uint8_t>& rgba) {
  std::string file(18, '\0');
  file[2] = 2, file[12] = static_cast<char>(rgba.size() / 4), file[14] = 1, file[16] = 32, file[17] = 0x28;
  for (std::size_t i = 0; i < rgba.size(); i += 4)
    for (std::size_t c : {2, 1, 0, 3}) file += static_cast<char>(rgba[i + c]);
  return file;
}
const std::vector<std::uint8_t> kRed = {255, 0, 0, 255};

struct Files {
  TemporaryFolder folder;
  ImportedScene material(const std::string& mtl) {
    folder.write("m.mtl", "newmtl m\n" + mtl);
    return load(folder.write("a.obj", std::string("mtllib m.mtl\n") + kQuad + "usemtl m\n" + kFace));
  }
  void make(const char* name) { REQUIRE(mkdir((folder.path + "/" + name).c_str(), 0700) == 0); }
};

const Material& first(const ImportedScene& imported) { return imported.scene.materials[0]; }
int alpha(const ImportedScene& imported, std::uint32_t texel) {
  return static_cast<int>(reinterpret_cast<const std::uint8_t*>(imported.scene.texels.data)[4 * texel + 3]);
}

}  // namespace

// Goal: names of materials may have spaces.
TEST_CASE("mtl_names_may_have_spaces") {
  Files f;
  f.folder.write("m.mtl", "newmtl dark wood\nKd 1 0 0\nnewmtl dark stone # grey\nKd 0 1 0\n");
  const ImportedScene imported = load(f.folder.write(
      "a.obj", std::string("mtllib m.mtl\n") + kQuad + "usemtl dark stone\nf 1 2 3\nusemtl dark wood \nf 1 3 4\n"));
  CHECK(imported.warning.empty());
  CHECK(imported.scene.materials[imported.scene.triangles[0].material()].diffuse.y == 1);
  CHECK(imported.scene.materials[imported.scene.triangles[1].material()].diffuse.x == 1);
}

// Goal: a number missing in a colour is as the first; spectra, unknown statements and comments are not fatal, and what
// is not used is named.
TEST_CASE("mtl_colors_and_statements_that_programs_write") {
  Files f;
  CHECK(first(f.material("Kd 0.5\n")).diffuse == Vec3{0.5f, 0.5f, 0.5f});
  CHECK(first(f.material("Kd 0.5 0.25\n")).diffuse == Vec3{0.5f, 0.25f, 0.5f});
  const ImportedScene spectral =
      f.material("Kd spectral ident.rfl 1\nKs xyz 1 1\nwobble 3\nmap_wobble a.png\n# Kd 1 0 0\n");
  for (const char* part : {"spectral", "'wobble' of MTL", "'map_wobble' of MTL"})
    CHECK(contains(spectral.warning, part));
  CHECK(first(spectral).diffuse == Material().diffuse);
  CHECK(first(f.material("Kd 0.25 0.5 1 # blue\n")).diffuse == Vec3{0.25f, 0.5f, 1});
  const ImportedScene halo = f.material("d -halo 0.5\n");
  CHECK((first(halo).opacity == 0.5f && contains(halo.warning, "-halo")));
  const ImportedScene obj =
      load(f.folder.write("b.obj", "v 0 0 0 # a\nv 1 0 0# 7\nv 0 1 0\nmg 1 2\nf 1 2 3 # tri\n#f 1 2 9\n"));
  CHECK((obj.scene.triangles.count == 1 && contains(obj.warning, "'mg'")));
}

// Goal: a colour that would hide a texture, or no colour, shows the texture; without either, the material is grey.
TEST_CASE("mtl_without_diffuse_color_shows_its_texture") {
  Files f;
  f.folder.write("t.tga", tga(kRed));
  const ImportedScene hidden = f.material("Kd 0 0 0\nmap_Kd t.tga\n"), unsaid = f.material("map_Kd t.tga\n");
  CHECK((first(hidden).diffuse == Vec3{1, 1, 1} && contains(hidden.warning, "'m': Kd 0 would hide its map_Kd")));
  CHECK((first(unsaid).diffuse == Vec3{1, 1, 1} && unsaid.warning.empty()));
  CHECK(first(f.material("Kd 0 0 0\n")).diffuse == Vec3{0, 0, 0});
  CHECK(first(f.material("Ns 10\n")).diffuse == Material().diffuse);
  CHECK(first(f.material("Kd 0.5 0.5 0.5\nmap_Kd t.tga\n")).diffuse == Vec3{0.5f, 0.5f, 0.5f});
}

// Goal: a material that nobody will see is named with its place and what to change; a map_d decides instead.
TEST_CASE("mtl_full_transparency_is_named") {
  Files f;
  f.folder.write("t.tga", tga({255, 255, 255, 255, 0, 0, 0, 255}));
  for (const char* statement : {"Tr 1", "d 0", "d 0.0", "Tr 1.0"}) {
    CAPTURE(std::string(statement));
    const ImportedScene clear = f.material(std::string("Kd 1 1 1\n") + statement + "\nmap_Kd t.tga\n");
    CHECK(first(clear).opacity == 0);
    CHECK(contains(clear.warning, "material 'm' is fully transparent (m.mtl, line 3: "));
    CHECK(contains(clear.warning, "write 'd 1'"));
    const ImportedScene masked = f.material(std::string("Kd 1 1 1\n") + statement + "\nmap_d t.tga\n");
    CHECK((first(masked).opacity == 1 && first(masked).alpha_mode == AlphaMode::mask && masked.warning.empty()));
  }
  CHECK(first(f.material("d 1\nTr 1\n")).opacity == 1);  // d counts
  CHECK(first(f.material("Tr 1\nd 1\n")).opacity == 1);
}

// Goal: options of maps that the specification has leave the map's name intact.
TEST_CASE("mtl_map_options_are_read") {
  Files f;
  f.folder.write("a b.tga", tga(kRed));
  for (const char* options :
       {"", "-s 2 2 ", "-s 2 ", "-s 2 2 2 ", "-o 0.5 0.5 -t 0 0 0 ", "-mm 0 1 ", "-cc off ", "-blendu on -blendv off ",
        "-texres 256 ", "-imfchan r ", "-clamp off ", "-bm 1 ", "-blendu on -blendv on -cc off -mm 0 1 -texres 256 "}) {
    CAPTURE(std::string(options));
    const ImportedScene imported = f.material(std::string("map_Kd ") + options + "a b.tga\n");
    CHECK(imported.warning.empty());
    REQUIRE(imported.scene.textures.count == 1);
    const float scale = first(imported).diffuse_texture.m[0][0];
    CHECK(scale == (contains(options, "-s 2") ? 2 : 1));
  }
  CHECK(first(f.material("map_Kd -s 2 3 a b.tga\n")).diffuse_texture.m[1][1] == 3);
  CHECK(f.material("map_Kd -mm 0 0.5 a b.tga\n").scene.texels[0] ==
        f.material("map_Kd -mm 0 0.5 a b.tga\n").scene.texels[0]);
  CHECK((f.material("map_Kd -mm 0 0.5 a b.tga\n").scene.texels[0] & 255) == 128);
  CHECK((f.material("map_Kd -mm 0.5 0.5 a b.tga\n").scene.texels[0] & 0xFFFFFF) == 0x8080FF);
}

// Goal: a mask with alpha is its alpha, without it red; -imfchan chooses; its own -s and -o hold for it alone.
TEST_CASE("mtl_masks_are_their_alpha_or_the_channel_asked_for") {
  Files f;
  f.folder.write("grey.tga", tga({255, 255, 255, 255, 0, 0, 0, 255}));
  f.folder.write("leaf.tga", tga({10, 255, 30, 255, 10, 200, 30, 0}));
  CHECK((alpha(f.material("map_d grey.tga\n"), 0) == 255 && alpha(f.material("map_d grey.tga\n"), 1) == 0));
  const ImportedScene leaf = f.material("map_Kd leaf.tga\nmap_d leaf.tga\n");
  CHECK((alpha(leaf, 0) == 255 && alpha(leaf, 1) == 0 && first(leaf).alpha_mode == AlphaMode::mask));
  CHECK(alpha(f.material("map_d -imfchan r leaf.tga\n"), 1) == 10);
  CHECK(alpha(f.material("map_d -imfchan g leaf.tga\n"), 1) == 200);
  CHECK(alpha(f.material("map_d -imfchan b leaf.tga\n"), 1) == 30);
  CHECK(alpha(f.material("map_d -imfchan l leaf.tga\n"), 1) == 147);
  CHECK(alpha(f.material("map_d -imfchan m leaf.tga\n"), 1) == 0);
  f.folder.write("white.tga", tga({255, 255, 255, 255}));
  const ImportedScene twice = f.material("map_Kd white.tga\nmap_d -s 2 1 grey.tga\n");
  REQUIRE(twice.scene.textures[0].width == 4);
  for (std::uint32_t i = 0; i < 4; ++i) CHECK(alpha(twice, i) == (i % 2 == 0 ? 255 : 0));
  CHECK(first(twice).diffuse_texture.m[0][0] == 1);
  const ImportedScene colors = f.material("map_Kd -s 2 1 grey.tga\nmap_d grey.tga\n");
  REQUIRE(colors.scene.textures[0].width == 4);
  for (std::uint32_t i = 0; i < 4; ++i) CHECK(alpha(colors, i) == (i < 2 ? 255 : 0));
  CHECK(first(colors).diffuse_texture.m[0][0] == 1);
  const ImportedScene odd = f.material("map_Kd -s 2 1 grey.tga\nmap_d -s 3 1 grey.tga\n");
  CHECK(contains(odd.warning, "neither repeats within the other"));
}

// Goal: files are found beside the MTL, then beside the OBJ, then by their last name, which is said once; backslashes
// divide; without a file that mtllib names, the model's own is tried.
TEST_CASE("mtl_files_are_looked_for_where_programs_put_them") {
  Files f;
  f.make("mats"), f.make("maps");
  f.folder.write("mats/in.tga", tga(kRed));
  f.folder.write("maps/up.tga", tga(kRed));
  f.folder.write("here.tga", tga(kRed));
  f.folder.write("mats/sub.mtl", "newmtl m\nmap_Kd in.tga\nmap_Ke maps\\up.tga\n");
  const std::string rest = std::string(kQuad) + "usemtl m\n" + kFace;
  for (const char* name : {"mats/sub.mtl", "mats\\sub.mtl"}) {
    const ImportedScene imported = load(f.folder.write("a.obj", std::string("mtllib ") + name + "\n" + rest));
    CHECK_MESSAGE(imported.warning.empty(), imported.warning);
    CHECK(imported.scene.textures.count == 2);
  }
  for (const char* name :
       {"C:\\Users\\me\\here.tga", "/home/me/here.tga", "../textures/here.tga", "textures/here.tga"}) {
    CAPTURE(std::string(name));
    const ImportedScene imported = f.material(std::string("map_Kd ") + name + "\nmap_Ke " + name + "\n");
    CHECK(imported.scene.textures.count == 2);
    CHECK(imported.warning == "files in missing folders are read from beside the model instead");
  }
  CHECK(contains(f.material("map_Kd /home/me/gone.tga\n").warning, "gone.tga"));
  f.folder.write("c.mtl", "newmtl m\nKd 0 0.5 0\n");
  for (const char* line : {"", "mtllib gone.mtl\n"}) {
    const ImportedScene own = load(f.folder.write("c.obj", std::string(line) + rest));
    CHECK(first(own).diffuse == Vec3{0, 0.5f, 0});
    CHECK(own.warning == "its materials are those of c.mtl, which it does not name");
  }
  CHECK(load(f.folder.write("d.obj", rest)).warning == "faces without a known material got the default one");
  CHECK(load(f.folder.write("c.obj", std::string(kQuad) + kFace)).warning.empty());
}

// Goal: `s off` is flat, `s N` smooth within its group at any angle; without `s`, the crease angle holds. Method: a
// roof of two squares, folded by 30° and 90°; a third square of another group.
TEST_CASE("obj_smoothing_groups_are_kept") {
  TemporaryFolder folder;
  auto roof = [&](const char* height, const std::string& before, const std::string& between) {
    return load(folder.write("a.obj", std::string("v -1 0 0\nv 0 0 ") + height + "\nv 1 0 0\nv -1 1 0\nv 0 1 " +
                                          height + "\nv 1 1 0\n" + before + "f 1 2 5 4\n" + between + "f 2 3 6 5\n"));
  };
  auto is_smooth = [](const ImportedScene& imported) {
    int upright = 0;
    for (std::uint32_t i = 0; i < imported.scene.normals.count; ++i) upright += imported.scene.normals[i].z > 0.9999f;
    return upright == 2;  // the two vertices on the ridge
  };
  CHECK(is_smooth(roof(".27", "", "")));
  CHECK(roof("1", "", "").scene.normals.empty());
  CHECK(roof(".27", "s off\n", "").scene.normals.empty());
  CHECK(roof(".27", "s 0\n", "").scene.normals.empty());
  CHECK(is_smooth(roof(".27", "s 1\n", "")));
  CHECK(is_smooth(roof("1", "s 1\n", "")));
  CHECK(roof(".27", "s 1\n", "s 2\n").scene.normals.empty());
  CHECK(roof(".27", "s 1\n", "s off\n").scene.normals.empty());
  CHECK(roof(".27", "", "s 1\n").scene.normals.empty());
}

// Goal: a smoothing group goes on across `g` and `o` where faces use one vertex line; surfaces that merely touch stay
// apart, as do other groups and faces before any `s`. Method: a folded strip of three squares and a fan of triangles,
// each face in a shape of its own; normals as without `g`.
TEST_CASE("obj_smoothing_groups_go_on_across_shapes") {
  TemporaryFolder folder;
  auto normals = [&](const std::string& text) {
    const ImportedScene imported = load(folder.write("a.obj", text));
    std::vector<std::pair<Vec3, Vec3>> list;  // places and normals
    for (std::uint32_t v = 0; v < imported.scene.normals.count; ++v)
      list.emplace_back(imported.scene.positions[v], imported.scene.normals[v]);
    return list;
  };
  const std::string points = "v -1 0 0\nv 0 0 1\nv 1 0 0\nv 2 0 3\nv -1 1 0\nv 0 1 1\nv 1 1 0\nv 2 1 3\nv 0 3 2\n";
  const std::vector<std::string> faces = {"f 1 2 6 5\n", "f 2 3 7 6\n", "f 3 4 8 7\n", "f 5 6 9\n", "f 6 7 9\n"};
  auto in_shapes = [&](const std::string& first, const std::string& word) {
    std::string text = points + first;
    for (std::size_t i = 0; i < faces.size(); ++i) text += word + " part" + std::to_string(i) + "\n" + faces[i];
    return text;
  };
  std::string whole = points + "s 1\n";
  for (const std::string& face : faces) whole += face;
  const auto expected = normals(whole);
  REQUIRE(expected.size() == 9);
  for (const char* word : {"g", "o"}) {
    const auto got = normals(in_shapes("s 1\n", word));
    CHECK(got.size() == 18);
    for (const auto& vertex : got)
      for (const auto& one : expected)
        if (one.first == vertex.first) CHECK(length(one.second - vertex.second) < 1e-6f);
    CHECK(normals(in_shapes("s off\n", word)).empty());
    CHECK(normals(in_shapes("", word)).empty());
  }
  CHECK(normals(points + "s 1\n" + faces[0] + "g b\ns 2\n" + faces[1]).empty());
  CHECK(normals(points + "s 1\n" + faces[0] + "o b\nv 0 0 1\nv 1 0 0\nv 0 1 1\nv 1 1 0\nf -4 -3 -1 -2\n").empty());
}
