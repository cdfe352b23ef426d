// Files made to break a reader: each ends in a scene or in one line of explanation.
#include <dirent.h>

#include <algorithm>
#include <vector>

#include "desktop/import/scene_builder.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"

using namespace pocketray;

// Assimp leaks a few kilobytes when its PLY reader refuses a file; that leak is not ours and hides none of ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

static void list_files(const std::string& folder, std::vector<std::string>* files) {
  DIR* dir = opendir(folder.c_str());
  if (!dir) return;
  while (dirent* entry = readdir(dir)) {
    std::string name = entry->d_name, path = folder + "/" + name;
    if (name == "." || name == "..") continue;
    struct stat info;
    if (stat(path.c_str(), &info) != 0) continue;
    if (S_ISDIR(info.st_mode)) list_files(path, files);
    if (S_ISREG(info.st_mode)) files->push_back(path);
  }
  closedir(dir);
}

// Goal: no file crashes the reader or lets an exception out, and every refusal is one clear line. Method: import every
// file of the hostile collection whose ending the reader knows; run under the sanitizers as well.
TEST_CASE("import_hostile_files_end_in_a_scene_or_one_line") {
  if (!have(shared_scene("hostile"))) return;
  std::vector<std::string> files;
  list_files(shared_scene("hostile"), &files);
  std::sort(files.begin(), files.end());
  CHECK(files.size() > 300);
  int read = 0, refused = 0;
  for (const std::string& path : files) {
    CAPTURE(path);
    ImportOptions options;
    options.byte_count_max = 64 << 20;
    ImportedScene result;
    Status status = import_scene(path, options, &result);
    if (status.ok) ++read;
    if (!status.ok) {
      ++refused;
      std::string message = status.message;
      CHECK(message.size() > path.size() + 10);
      CHECK(message.find('\n') == std::string::npos);
    }
    if (std::getenv("POCKETRAY_VERBOSE"))
      std::printf("%s | %s\n", path.c_str(), status.ok ? ("OK " + result.warning).c_str() : status.message);
  }
  std::printf("hostile: %d read, %d refused\n", read, refused);
  CHECK(read > 0);
  CHECK(refused > 0);
}

namespace {

std::string error_of(const std::string& name, const std::string& content,
                     const ImportOptions& options = ImportOptions()) {
  TemporaryFolder folder;
  return load_error(folder.write(name, content), options);
}
// A document of one triangle with `from` replaced by `to`.
std::string altered(const std::string& from, const std::string& to) {
  std::string text = triangle_gltf("{}", ",\"images\":[],\"textures\":[]");
  std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

// Goal: inconsistent glTF files are refused with the reason. Method: one inconsistency each in an otherwise valid
// document.
TEST_CASE("gltf_lies_are_refused_with_the_reason") {
  const char* const cases[][3] = {
      {"\"count\":3", "\"count\":4", "do not fit into buffer view 0"},
      {"\"count\":3", "\"count\":4000000000", "MiB"},
      {"\"count\":3", "\"count\":18446744073709551615", "MiB"},
      {"\"byteOffset\":0", "\"byteOffset\":80", "beyond its buffer"},
      {"\"byteOffset\":0", "\"byteOffset\":18446744073709551600", "beyond its buffer"},
      {"\"bufferView\":0", "\"bufferView\":7", "buffer view 7 does not exist"},
      {"\"buffer\":0", "\"buffer\":3", "buffer 3, which does not exist"},
      {"{\"byteLength\":", "{\"byteLength\":1", "copy the file again"},
      {"\"componentType\":5126", "\"componentType\":5130", "wrong type"},
      {"\"POSITION\":0", "\"POSITION\":77", "accessor 77 does not exist"},
      {"\"mesh\":0", "\"mesh\":5", "mesh 5 does not exist"},
      {"\"mesh\":0", "\"mesh\":0,\"children\":[0]", "reached twice"},
      {"\"mesh\":0", "\"mesh\":0,\"skin\":0", "skin 0 does not exist"},
      {"\"mesh\":0", "\"mesh\":0,\"camera\":9", "camera 9 does not exist"},
      {"\"mesh\":0", "\"mesh\":0,\"rotation\":[0,0,0,0]", "not a quaternion"},
      {"\"mesh\":0", "\"mesh\":0,\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}", "light does not exist"},
      {"\"materials\":[{}", "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":4}}}",
       "texture 4 does not exist"},
      {"\"material\":0", "\"material\":8", "material 8 does not exist"},
      {"\"version\":\"2.0\"", "\"version\":\"1.0\"", "version '1.0'"},
      {"\"scene\":0", "\"scene\":3", "scene 3 does not exist"},
      {"\"scene\":0", "\"scene\":0,\"extensionsRequired\":[\"EXT_geometry_of_tomorrow\"]", "EXT_geometry_of_tomorrow"},
      {"\"uri\":\"data:application/octet-stream;base64,", "\"uri\":\"../../../../etc/passwd\",\"x\":\"",
       "beside the scene"},
      {"\"uri\":\"data:application/octet-stream;base64,", "\"uri\":\"%2Fetc/passwd\",\"x\":\"", "beside the scene"},
      {"\"uri\":\"data:application/octet-stream;base64,", "\"uri\":\"a/%2e%2e/%2e%2e/b\",\"x\":\"", "beside the scene"},
      {"\"scene\":0", "\"scene\":0,", "not a valid JSON"},
  };
  for (const auto& c : cases) {
    CAPTURE(c[1]);
    std::string error = error_of("a.gltf", altered(c[0], c[1]));
    CHECK_MESSAGE(contains(error, c[2]), error);
  }
  std::string deep = altered("\"scene\":0", "\"scene\":0,\"extras\":" + std::string(100000, '['));
  CHECK(contains(error_of("a.gltf", deep), "nests deeper"));
}

// Goal: an image whose header asks for a gigabyte is left out by its header. Method: 16,000 × 16,000 pixels in 33
// bytes.
TEST_CASE("gltf_image_header_that_lies_is_left_out") {
  std::string image = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAPoAAAD6ACAYAAABBft/e";
  std::string text = altered("\"images\":[],\"textures\":[]",
                             "\"images\":[{\"uri\":\"" + image + "\"}],\"textures\":[{\"source\":0}]");
  std::string material = "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}";
  text.replace(text.find("\"materials\":[{}"), 15, material);
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write("a.gltf", text));
  CHECK(contains(imported.warning, "image 0 is too large"));
  CHECK(imported.scene.textures.count == 0);
}

// Goal: files and scenes larger than the limit are refused. Method: limits around a small file.
TEST_CASE("import_byte_count_max_bounds_file_and_scene") {
  ImportOptions options;
  options.byte_count_max = 100;
  CHECK(contains(error_of("a.gltf", triangle_gltf(""), options), "more than the limit of 100"));
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.vec3s(std::vector<float>(3 * 30000, 0.0f));
  options.byte_count_max = 3 << 20;
  std::string instanced =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"extensions\":{"
      "\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":1}}}}],\"scenes\":[{\"nodes\":[0]}]";
  TemporaryFolder folder;
  CHECK(load(folder.write("a.glb", w.glb(instanced)), options).scene.triangles.count == 30000);
  options.byte_count_max = 1 << 20;
  CHECK(contains(error_of("a.glb", w.glb(instanced), options), "beyond 1 MiB"));
}

// Goal: instances are counted before any is built. Method: 30,000 of a mesh of 30,000 vertices, which are too many for
// any limit of bytes; if they were built, that limit would end it first.
TEST_CASE("import_counts_instances_before_it_builds_them") {
  GltfWriter w;
  w.vec3s(std::vector<float>(3 * 30000, 0.0f));
  w.vec3s(std::vector<float>(3 * 30000, 0.0f));
  ImportOptions options;
  options.byte_count_max = 16 << 20;
  const std::string instanced =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"extensions\":{"
      "\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":1}}}}],\"scenes\":[{\"nodes\":[0]}]";
  CHECK(contains(error_of("a.glb", w.glb(instanced), options), "vertices; simplify the model"));
}

// Goal: every byte of the geometry counts towards the limit, also what fills in for meshes without normals, texture
// coordinates or colours where others have them. Method: what is charged is what is there, in both orders.
TEST_CASE("import_counts_what_fills_in_for_other_meshes") {
  MeshData rich, poor;
  rich.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  rich.normals.assign(3, {0, 0, 1}), rich.uvs.resize(3), rich.colors.resize(3), rich.indices = {0, 1, 2};
  poor.positions.resize(1000), poor.indices = {0, 1, 2};
  for (const auto& meshes : {std::make_pair(rich, poor), std::make_pair(poor, rich)}) {
    SceneBuilder builder;
    append_mesh(&builder, meshes.first, Transform());
    append_mesh(&builder, meshes.second, Transform());
    const SceneArrays& out = *builder.out;
    CHECK(out.normals.size() == 1003);
    CHECK(builder.bytes_charged == 1003 * (2 * sizeof(Vec3) + sizeof(Vec2) + sizeof(Rgba16)) + 2 * sizeof(Triangle));
  }
}

// Goal: no prefix of a file and no flipped byte crashes the reader. Method: a .glb, an OBJ with its MTL and a PLY, cut
// at every length, and with every byte set to 0, to 0xFF or to itself with one bit turned.
TEST_CASE("import_every_prefix_and_every_changed_byte_ends_in_a_status") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.indices({0, 1, 2, 0});
  w.floats({0, 1});
  w.vec3s({0, 0, 0, 1, 2, 3});
  std::string glb = w.glb(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":5}]}],\"nodes\":[{\"mesh\":"
      "0}],"
      "\"scenes\":[{\"nodes\":[0]}],\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3}],\"channels\":[{"
      "\"sampler\":0,"
      "\"target\":{\"node\":0,\"path\":\"translation\"}}]}]");
  std::string obj =
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\nf 1/1/1 2//1 3/1 -1\nl 1 2\n";
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  TemporaryFolder folder;
  folder.write("a.mtl", "newmtl m\nKd 1 0 0\n");
  int read = 0, refused = 0;
  auto attempt = [&](const std::string& name, const std::string& content) {
    ImportedScene result;
    Status status = import_scene(folder.write(name, content), ImportOptions(), &result);
    ++(status.ok ? read : refused);
    if (!status.ok) CHECK(std::string(status.message).size() > 20);
  };
  for (auto [name, content] :
       {std::make_pair("a.glb", glb), std::make_pair("a.obj", obj), std::make_pair("a.ply", ply)}) {
    attempt(name, content);
    CHECK(read > 0);
    for (std::size_t i = 0; i < content.size(); ++i) {
      attempt(name, content.substr(0, i));
      const char changes[3] = {'\0', '\xFF', static_cast<char>(content[i] ^ (1 << (i % 8)))};
      std::string changed = content;
      changed[i] = changes[i % 3];
      attempt(name, changed);
    }
  }
  std::printf("prefixes and changed bytes: %d read, %d refused\n", read, refused);
  CHECK(refused > read / 10);
}

// Goal: files that are not scenes are refused with a list of the formats.
TEST_CASE("import_unknown_endings_empty_and_absent_files") {
  CHECK(contains(error_of("a.txt", "hello"), "gltf glb obj"));
  CHECK(contains(error_of("a.obj", ""), "empty"));
  CHECK(contains(load_error("/nowhere/a.glb"), "cannot read"));
  CHECK(contains(load_error("/"), "put a regular file there"));
  CHECK(contains(error_of("a.obj", "v 0 0 0\n"), "no triangles"));
}
