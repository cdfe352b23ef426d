// Stanford PLY, written here: faces, triangle strips, colours, both byte orders, and files that lie.
#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <vector>

#include "import/import_testing.h"

using namespace pocketray;

// Goal: PLY faces, vertex colours (display values, so sRGB) and normals arrive. Method: an ASCII file of a quad and a
// triangle.
TEST_CASE("ply_quads_and_vertex_colors") {
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
TEST_CASE("ply_header_that_lies_is_refused") {
  TemporaryFolder folder;
  for (const char* format : {"ascii", "binary_little_endian"}) {
    std::string error =
        load_error(folder.write("a.ply", std::string("ply\nformat ") + format +
                                             " 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
                                             "y\nproperty float z\nend_header\n0 0 0\n"));
    CHECK(contains(error, "states 4000000000"));
  }
}

// Goal: a file too short for a header is refused by name. Method: the beginnings of one.
TEST_CASE("ply_beginning_of_a_header_is_refused") {
  TemporaryFolder folder;
  const std::string header = "ply\nformat";
  for (std::size_t length = 1; length <= header.size(); ++length) {
    CAPTURE(length);
    std::string error = load_error(folder.write("a.ply", header.substr(0, length)));
    CHECK(contains(error, length < 3 ? "not a PLY file" : "PLY header"));
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

// Goal: faces with no corners, a negative number, too many, or missing vertices are refused by name. Method: such lists
// in text and binary, after a valid face; valid lists are read.
TEST_CASE("ply_faces_that_lie_are_refused") {
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

namespace {

constexpr const char* kFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

// The numbers as the format has them.
template <class T>
std::string written(const char* format, const std::vector<T>& values) {
  std::string bytes;
  for (T value : values) {
    if (format[0] == 'a') {
      bytes += std::to_string(value) + (bytes.size() % 7 == 0 ? "\n" : " ");
      continue;
    }
    char word[sizeof(T)];
    std::memcpy(word, &value, sizeof value);
    if (std::strcmp(format, "binary_big_endian") == 0) std::reverse(word, word + sizeof value);
    bytes.append(word, sizeof value);
  }
  return bytes;
}

// A grid of 4×2 vertices in the plane z = 0, x to the right and y up, and one list of strips.
std::string ply_of_strips(const char* format, const std::vector<std::int32_t>& strip, const char* line_end = "\n") {
  std::string header = std::string("ply\nformat ") + format +
                       " 1.0\ncomment end_header is not here\nelement vertex 8\nproperty float x\nproperty float y\n"
                       "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  std::string file;
  for (char c : header) file += c == '\n' ? line_end : std::string(1, c);
  std::vector<float> positions;
  for (float x : {0.0f, 1.0f, 2.0f, 3.0f})
    for (float y : {1.0f, 0.0f}) positions.insert(positions.end(), {x, y, 0.0f});
  std::vector<std::int32_t> list = {static_cast<std::int32_t>(strip.size())};
  list.insert(list.end(), strip.begin(), strip.end());
  return file + written(format, positions) + written(format, list);
}

// True if all triangles face +Z.
bool all_face_forward(const Scene& scene) {
  for (const Triangle& t : scene.triangles) {
    Vec3 a = scene.positions[t.vertex(0)], b = scene.positions[t.vertex(1)], c = scene.positions[t.vertex(2)];
    if (!(cross(b - a, c - a).z > 0)) return false;
  }
  return true;
}

}  // namespace

// Goal: triangle strips, as Stanford's models have them, give every triangle, facing as the first one does; -1 starts
// anew; triangles of equal vertices only connect. Method: a row of three squares as one strip, as three, and connected.
TEST_CASE("ply_triangle_strips") {
  TemporaryFolder folder;
  for (const char* format : kFormats) {
    CAPTURE(std::string(format));
    auto strips = [&](const std::vector<std::int32_t>& strip) {
      ImportOptions options;
      options.up = UpAxis::y;
      ImportedScene imported = load(folder.write("a.ply", ply_of_strips(format, strip)), options);
      CHECK(all_face_forward(imported.scene));
      CHECK(surface_area(imported.scene) == doctest::Approx(imported.scene.triangles.count / 2.0));
      return imported.scene.triangles.count;
    };
    CHECK(strips({0, 1, 2, 3, 4, 5, 6, 7}) == 6);
    CHECK(strips({0, 1, 2, -1, 2, 1, 3, -1, 2, 3, 4, 5, 6, 7, -1}) == 6);
    CHECK(strips({-1, -1, 0, 1, 2, 3, -1, 4, 5, -1, 6}) == 2);
    CHECK(strips({0, 1, 2, 3, 3, 4, 4, 5, 6, 7}) == 4);
    std::string error = load_error(folder.write("a.ply", ply_of_strips(format, {0, 1, 2, 8})));
    CHECK(contains(error, "strip 0 of the PLY file uses vertex 8 of 8"));
    CHECK(contains(load_error(folder.write("a.ply", ply_of_strips(format, {0, 1, -2}))), "uses vertex -2"));
    std::string whole = ply_of_strips(format, {0, 1, 2, 3, 4, 5, 6, 7});
    for (std::size_t size = whole.size() - 30; size < whole.size(); size += 3) {
      ImportedScene cut;
      Status status = import_scene(folder.write("a.ply", whole.substr(0, size)), ImportOptions(), &cut);
      CHECK((!status.ok || format[0] == 'a'));  // a cut number is a number
    }
  }
}

// Goal: the body begins behind the header's last line end, even if its first byte looks like another. Method: files of
// all three line ends whose first vertex begins with a line feed.
TEST_CASE("ply_binary_data_may_begin_with_a_line_end") {
  TemporaryFolder folder;
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    std::string file = ply_of_strips("binary_little_endian", {0, 1, 2}, line_end);
    std::string header = file.substr(0, file.size() - 8 * 12 - 16), body = file.substr(header.size());
    body[0] = '\n', body[1] = '\n';  // 3.6e-42 instead of 0
    ImportedScene imported = load(folder.write("a.ply", header + body));
    CHECK(imported.scene.triangles.count == 1);
    CHECK(surface_area(imported.scene) == doctest::Approx(0.5));
  }
}

// Goal: properties and elements that are not used are skipped, whatever their types, and named where they would show.
TEST_CASE("ply_skips_what_it_does_not_use") {
  TemporaryFolder folder;
  std::string header =
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement camera 1\nproperty list uchar float view\nelement "
      "vertex "
      "3\nproperty double quality\nproperty double x\nproperty double y\nproperty list char short "
      "neighbours\nproperty double z\nproperty ushort red\nproperty ushort green\nproperty ushort blue\nelement face "
      "1\nproperty uchar red\nproperty list uchar uint vertex_index\nproperty list uchar float texcoord\nend_header\n";
  ImportedScene imported = load(folder.write(
      "a.ply", header + "3 0.5 0.5 0.5\n9 0 0 0 0 65535 0 0\n9 1 0 2 7 7 0 65535 0 0\n9 0 1 1 5 0 65535 0 0\n"
                        "200 3 0 1 2 6 0 0 0 0 0 0\n"));
  CHECK(imported.scene.triangles.count == 1);
  CHECK(surface_area(imported.scene) == doctest::Approx(0.5));
  REQUIRE(imported.scene.colors.count == 3);
  CHECK(imported.scene.colors[2].r == 65535);
  CHECK(imported.scene.colors[2].g == 0);
  CHECK(contains(imported.warning, "a texture is missing"));
}
