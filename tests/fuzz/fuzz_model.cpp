// Models of untrusted bytes in a temporary folder: imported, baked, opened, rendered.
#ifdef POCKETRAY_HAVE_IMPORT
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "base/check.h"
#include "fuzz/fuzz.h"
#include "scene/baked_file.h"
#include "session/model_import.h"

namespace pocketray {
namespace {

// A folder for the files, removed at program exit.
struct FuzzFolder {
  std::string path;
  FuzzFolder() {
    const char* base = std::getenv("TMPDIR");
    path = std::string(base ? base : "/tmp") + "/pocketray_fuzz_XXXXXX";
    if (!mkdtemp(&path[0])) std::perror(path.c_str()), std::abort();
  }
  ~FuzzFolder() {
    for (const std::string& ending : import_endings()) std::remove((path + "/a." + ending).c_str());
    rmdir(path.c_str());
  }
};

void write_file(const std::string& path, const void* bytes, std::size_t byte_count) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  bool written = file && (byte_count == 0 || std::fwrite(bytes, byte_count, 1, file) == 1);
  if (!file || std::fclose(file) != 0 || !written) std::perror(path.c_str()), std::abort();
}

}  // namespace

// glTF and OBJ first; an .mtl is read through an OBJ that names it.
std::vector<std::string> import_endings() {
  std::vector<std::string> endings = {"mtl"};
  std::string all = import_formats() + " ";
  for (std::size_t at = 0, end; (end = all.find(' ', at)) != std::string::npos; at = end + 1)
    if (end > at) endings.push_back(all.substr(at, end - at));
  return endings;
}

void fuzz_model(const std::string& ending, const std::uint8_t* bytes, std::size_t byte_count) {
  static const FuzzFolder folder;
  std::string path = folder.path + "/a." + ending;
  write_file(path, bytes, byte_count);
  if (ending == "mtl") {
    static const char kObj[] = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    path = folder.path + "/a.obj";
    write_file(path, kObj, sizeof kObj - 1);
  }
  ImportOptions options;
  options.byte_count_max = 16u << 20;
  options.cpu_seconds_max = 1;
  ImportedScene imported;
  Status status = import_scene(path, options, &imported);
  if (!status.ok) {
    CHECK(std::string(status.message).find('\n') == std::string::npos);
    return;
  }
  ++fuzz_counts.imports;
  BakedFile file = bake(imported.scene);
  Scene opened;
  CHECK(baked_open(file.data(), file.size(), &opened).ok);
  fuzz_render(opened);
}

}  // namespace pocketray
#endif
