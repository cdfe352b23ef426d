// Concave polygons, face colours and upright models as the importers read them.
#include <cmath>
#include <vector>

#include "import/import_testing.h"
#include "import/polygon_testing.h"

using namespace pocketray;

namespace {

// A wall with a door: the door is open whatever corner comes first.
const std::vector<Vec2> kWall = {{-1, 1},      {-1, -1},   {-.25f, -1}, {-.25f, .25f},
                                 {.25f, .25f}, {.25f, -1}, {1, -1},     {1, 1}};
constexpr double kWallArea = 4 - 0.5 * 1.25;

bool reads(const char* ending) {
  if (contains(" " + import_formats() + " ", std::string(" ") + ending + " ")) return true;
  std::printf("skipped: this build does not read .%s\n", ending);
  return false;
}

std::string points(const std::vector<Vec2>& loop, const std::string& before, const std::string& after) {
  std::string text;
  for (const Vec2& p : loop) text += before + std::to_string(p.x) + " " + std::to_string(p.y) + " 0" + after;
  return text;
}
std::string indices(std::size_t count, std::size_t first, std::size_t base) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += " " + std::to_string((first + i) % count + base);
  return text;
}

std::string ply(const std::string& properties, const std::string& faces, const std::string& comment = "") {
  return "ply\nformat ascii 1.0\n" + comment +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
         "element face 1\nproperty list uchar int vertex_indices\n" +
         properties + "end_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3 " + faces + "\n";
}

std::string stl(const std::string& name, const std::string& corners) {
  std::string text = "solid " + name + "\n";
  if (!corners.empty()) text += "facet normal 0 0 0\nouter loop\n" + corners + "endloop\nendfacet\n";
  return text + "endsolid " + name + "\n";
}

}  // namespace

// Goal: every importer that sees polygons fills them by the even-odd rule. Method: a wall with a door, from each of its
// corners.
TEST_CASE("hard_68_polygons_are_filled_alike_in_every_format") {
  TemporaryFolder folder;
  const std::size_t n = kWall.size();
  for (std::size_t first = 0; first < n; ++first) {
    CAPTURE(first);
    auto check = [&](const char* name, const std::string& text) {
      CAPTURE(std::string(name));
      CHECK(surface_area(load(folder.write(name, text)).scene) == doctest::Approx(kWallArea).epsilon(1e-6));
    };
    check("a.obj", points(kWall, "v ", "\n") + "f" + indices(n, first, 1) + "\n");
    check("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face "
          "1\n"
          "property list uchar int vertex_indices\nend_header\n" +
              points(kWall, "", "\n") + "8" + indices(n, first, 0) + "\n");
    if (reads("off")) check("a.off", "OFF\n8 1 0\n" + points(kWall, "", "\n") + "8" + indices(n, first, 0) + "\n");
    if (reads("x3d"))
      check("a.x3d",
            "<?xml version=\"1.0\"?><X3D version=\"3.3\"><Scene><Shape><IndexedFaceSet convex=\"false\" coordIndex=\"" +
                indices(n, first, 0) + " -1\"><Coordinate point=\"" + points(kWall, "", " ") +
                "\"/></IndexedFaceSet></Shape></Scene></X3D>");
  }
}

// Goal: a face that names a corner twice has as many triangles as its corners say. Method: a quadrilateral, and a file
// that others report as read wrongly.
TEST_CASE("hard_68_corners_named_twice_keep_their_triangles") {
  TemporaryFolder folder;
  const ImportedScene quad = load(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2 3\n"));
  CHECK(quad.scene.triangles.count == 2);
  const std::string path = shared_scene("hostile/tinyobjloader/issue-319-002.obj");
  if (!have(path)) return;
  const ImportedScene imported = load(path);
  CHECK(imported.scene.triangles.count == 14);
  CHECK(surface_area(imported.scene) == doctest::Approx(19.58).epsilon(1e-3));
}

// Goal: corners of a concave face keep their texture coordinates and normals. Method: coordinates that equal positions.
TEST_CASE("hard_68_corners_of_polygons_keep_their_attributes") {
  TemporaryFolder folder;
  std::string text = points(kWall, "v ", "\n"), face = "f";
  for (std::size_t i = 0; i < kWall.size(); ++i) {
    text += "vt " + std::to_string(kWall[i].x) + " " + std::to_string(kWall[i].y) + "\nvn 0 0 " +
            std::to_string(i + 1) + "\n";
    const std::string index = std::to_string(i + 1);
    face += " " + index + "/" + index + "/" + index;
  }
  folder.write("m.mtl", "newmtl m\nmap_Kd t.tga\n");
  std::string image(18, '\0');
  image[2] = 2, image[12] = 1, image[14] = 1, image[16] = 24;
  folder.write("t.tga", image + "abc");
  const ImportedScene imported = load(folder.write("a.obj", "mtllib m.mtl\n" + text + "usemtl m\n" + face + "\n"));
  const Scene& s = imported.scene;
  REQUIRE((s.uvs.count == 8 && s.normals.count == 8));
  for (std::uint32_t i = 0; i < 8; ++i) CHECK((s.uvs[i].x == s.positions[i].x && 1 - s.uvs[i].y == s.positions[i].y));
}

// Goal: a face of 200,000 corners is read at once, with no more than its own number of triangles.
TEST_CASE("hard_68_obj_face_of_200000_corners") {
  TemporaryFolder folder;
  const std::vector<Vec2> loop = star(200000, .2f, 2);
  std::string text = points(loop, "v ", "\n") + "f" + indices(loop.size(), 7, 1) + "\n";
  CHECK(load(folder.write("a.obj", text)).scene.triangles.count > 190000);
}

// Goal: a PLY file's texture, by vertices and by corners, and colours of faces.
TEST_CASE("ply_textures_and_face_colors") {
  TemporaryFolder folder;
  std::string image(18, '\0');
  image[2] = 2, image[12] = 1, image[14] = 1, image[16] = 24;
  folder.write("a b.tga", image + std::string("\x1\x2\xFF", 3));
  const std::string names = "comment TextureFile a b.tga\n";
  for (const auto& text :
       {ply("", "", names), ply("property list uchar float texcoord\n", "8 0 0 1 0 1 1 0 1", names)}) {
    const ImportedScene imported = load(folder.write("a.ply", text));
    const Scene& s = imported.scene;
    REQUIRE((s.textures.count == 1 && s.uvs.count == 4));
    CHECK(s.materials[0].diffuse_texture.texture == 0);
    CHECK((s.texels[0] & 255) == 255);
    for (std::uint32_t i = 0; i < 4; ++i) CHECK((s.uvs[i].x == s.positions[i].x && s.uvs[i].y == 1 + s.positions[i].z));
  }
  const ImportedScene colored =
      load(folder.write("a.ply", ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", "255 188 0")));
  REQUIRE(colored.scene.colors.count == 4);
  for (const Rgba16& c : colored.scene.colors) CHECK((c.r == 65535 && c.b == 0 && c.g > 32000 && c.g < 34000));
  CHECK(contains(load(folder.write("a.ply", ply("", "", "comment TextureFile gone.png\n"))).warning, "gone.png"));
  const std::string cloud =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
      "0\n1 1 1\n";
  CHECK(contains(load_error(folder.write("a.ply", cloud)), "2 points without faces"));
}

// Goal: PLY and STL have Z up, others Y, unless --up says otherwise; scans by Stanford's programs have Y up. Method: a
// tower of height 6.
TEST_CASE("models_stand_upright") {
  TemporaryFolder folder;
  const std::string corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 0 6\n";
  const std::string header =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty "
      "list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 6\n3 0 1 2\n";
  const std::string start = "ply\nformat ascii 1.0\n";
  struct Case {
    const char* name;
    std::string text;
    UpAxis usual;
  };
  const Case cases[] = {{"a.stl", stl("a", corners), UpAxis::z},
                        {"a.ply", start + header, UpAxis::z},
                        {"b.ply", start + "comment zipper output\n" + header, UpAxis::y},
                        {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0 6\n3 0 1 2\n", UpAxis::y},
                        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 0 6\nf 1 2 3\n", UpAxis::y}};
  for (const Case& c : cases)
    for (UpAxis up : {UpAxis::of_format, UpAxis::y, UpAxis::z}) {
      if (!reads(c.name + 2)) continue;
      CAPTURE(std::string(c.name));
      ImportOptions options;
      options.up = up;
      const ImportedScene imported = load(folder.write(c.name, c.text), options);
      const Vec3 size = extent(bounds(imported.scene));
      const bool is_z = (up == UpAxis::of_format ? c.usual : up) == UpAxis::z;
      CHECK((is_z ? size.y : size.z) == 6);
      CHECK(contains(imported.warning, "its Z axis points up") == (is_z && up == UpAxis::of_format));
    }
}

// Goal: an empty solid beside others does not refuse an STL file; a Blender project says what to do.
TEST_CASE("assimp_stl_with_an_empty_solid_and_blender_projects") {
  TemporaryFolder folder;
  const std::string corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  if (reads("stl"))
    for (const std::string& text : {stl("a", "") + stl("b", corners), stl("a", corners) + stl("b", ""),
                                    stl("a", corners) + stl("", "") + stl("c", corners)})
      CHECK(load(folder.write("a.stl", text)).scene.triangles.count >= 1);
  CHECK(contains(load_error(folder.write("a.blend", "BLENDER-v279REND")), "export it as glTF"));
}
