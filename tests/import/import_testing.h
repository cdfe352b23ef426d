// Shared by the import tests: sample files, generated scene files, and small queries of a scene.
#pragma once
#include <doctest/doctest.h>
#include <unistd.h>

#include <sys/stat.h>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "session/model_import.h"

namespace pocketray {

inline std::string shared_scene(const std::string& name) { return std::string(POCKETRAY_SHARED) + "/scenes/" + name; }

// True if the file exists; otherwise prints what is skipped.
inline bool have(const std::string& path) {
  struct stat info;
  if (stat(path.c_str(), &info) == 0) return true;
  std::printf("skipped: %s is absent\n", path.c_str());
  return false;
}

// Loads all of the file's contents, whether or not a picture shows them.
inline ImportedScene load(const std::string& path, ImportOptions options = ImportOptions()) {
  options.reduce = false;
  ImportedScene result;
  Status status = import_scene(path, options, &result);
  CHECK_MESSAGE(status.ok, std::string(status.message));
  CHECK(result.warning.find('\n') == std::string::npos);
  return result;
}

inline std::string load_error(const std::string& path, const ImportOptions& options = ImportOptions()) {
  ImportedScene result;
  Status status = import_scene(path, options, &result);
  CHECK(!status.ok);
  return status.message;
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A folder removed at the end of the test.
struct TemporaryFolder {
  std::string path;
  TemporaryFolder() {
    const char* base = std::getenv("TMPDIR");
    std::string name = std::string(base ? base : "/tmp") + "/pocketray_import_XXXXXX";
    char* made = mkdtemp(&name[0]);
    REQUIRE(made != nullptr);
    path = made;
  }
  ~TemporaryFolder() { CHECK(std::system(("rm -rf '" + path + "'").c_str()) == 0); }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path + "/" + name, std::ios::binary) << content;
    return path + "/" + name;
  }
};

inline Box bounds(const Scene& scene) {
  Box box = empty_box();
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) box = merge(box, scene.positions[v]);
  return box;
}

inline double surface_area(const Scene& scene) {
  double area = 0;
  for (const Triangle& t : scene.triangles) {
    Vec3 a = scene.positions[t.vertex(0)], b = scene.positions[t.vertex(1)], c = scene.positions[t.vertex(2)];
    area += 0.5 * static_cast<double>(length(cross(b - a, c - a)));
  }
  return area;
}

// The end of a glTF file with a texture of 2 × 2 texels of (0, 128, 64).
constexpr const char* kSmallTexture =
    ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAEElEQVR42mNgaHD4D8YwBgA5dAb9ejoCwQAAAABJRU5ErkJggg==\"}]";

// Loads the text of a glTF file.
inline ImportedScene load_gltf(const std::string& text) {
  TemporaryFolder folder;
  return load(folder.write("scene.gltf", text));
}

}  // namespace pocketray
