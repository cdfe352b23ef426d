#include "session/model_import.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>

#include "desktop/import/assimp.h"
#include "desktop/import/contained.h"
#include "desktop/import/files.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"
#include "desktop/import/obj.h"
#include "desktop/import/ply.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {
namespace {

bool is_gltf(const std::string& ending, const Bytes& bytes) {
  return ending == "gltf" || ending == "glb" || (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0);
}

// Runs read(builder) in a child process and takes the resulting scene.
template <class Read>
void read_contained(const ContainerLimits& limits, const std::string& path, const ImportOptions& options, Read read,
                    ImportedScene* result) {
  import_contained(
      limits,
      [&](ImportedScene* imported) {
        SceneBuilder builder;
        builder.options = options;
        builder.files.root = options.root;
        note_file(&builder.files, path);
        read(&builder);
        finish_scene(&builder, path_stem(path), imported);
      },
      result);
}

// Assimp's many readers trust their files and may crash, so they run in a child process. The glTF, OBJ and PLY readers
// run in place, with checks before and after that are fuzzed.
void import_by_assimp(const std::string& path, const std::string& ending, const Bytes& bytes,
                      const ImportOptions& options, ImportedScene* result) {
  // Assimp needs up to about 30 times the size of a point or text file; a compressed one may first grow tenfold.
  std::uint64_t memory_bytes = (std::uint64_t(512) << 20) + 256 * static_cast<std::uint64_t>(bytes.size());
  memory_bytes = std::min(memory_bytes, 8 * options.byte_count_max + (std::uint64_t(256) << 20));
  // On a busy machine, it may take ten times as long.
  const ContainerLimits limits = {memory_bytes, options.cpu_seconds_max, 10 * options.cpu_seconds_max,
                                  2 * options.byte_count_max};
  read_contained(
      limits, path, options, [&](SceneBuilder* builder) { import_assimp(path, ending, bytes, builder); }, result);
}

// Draco's decoder trusts the counts in its data, so it runs in a child process, too.
bool names_draco(const Bytes& bytes) {
  constexpr char kName[] = "KHR_draco_mesh_compression";
  return std::search(bytes.begin(), bytes.end(), std::begin(kName), std::end(kName) - 1) != bytes.end();
}
void import_by_draco(const std::string& path, const Bytes& bytes, const ImportOptions& options, ImportedScene* result) {
  const ContainerLimits limits = {2 * options.byte_count_max + (std::uint64_t(256) << 20), options.cpu_seconds_max,
                                  10 * options.cpu_seconds_max, 2 * options.byte_count_max};
  read_contained(
      limits, path, options, [&](SceneBuilder* builder) { import_gltf(path, bytes, builder); }, result);
}

void import_any(const std::string& path, const ImportOptions& options, ImportedScene* result) {
  std::string ending = path_ending(path);
  FilesRead files;
  files.root = options.root;
  Bytes bytes = read_file(path, options.byte_count_max, &files);
  if (bytes.empty()) fail_import("the file is empty");
  bool gltf = is_gltf(ending, bytes);
  if (!gltf && ending != "obj" && ending != "ply") {
    if (assimp_reads(ending)) return import_by_assimp(path, ending, bytes, options, result);
    if (ending == "blend") fail_import("it is a Blender project; export it as glTF (File, Export, glTF 2.0)");
    if (ending == "pray") fail_import("it is already baked; bake the model it was made from");
    if (ending.empty()) fail_import("its name has no ending that tells its format: rename it as .glb, .obj, .ply, …");
    fail_import("no reader for '.%.20s' files; convert to one of: %s", ending.c_str(), import_formats().c_str());
  }
  if (gltf && names_draco(bytes)) return import_by_draco(path, bytes, options, result);
  SceneBuilder builder;
  builder.options = options;
  builder.files = std::move(files);
  if (gltf)
    import_gltf(path, std::move(bytes), &builder);
  else if (ending == "ply")
    import_ply(path, bytes, &builder);
  else
    import_obj(path, std::move(bytes), &builder);
  finish_scene(&builder, path_stem(path), result);
}

// A Status is one line, but library messages may contain line feeds and other control characters.
Status one_line_failure(const std::string& path, const char* message) {
  const bool named = std::strstr(message, path.c_str()) != nullptr;
  Status status = named ? failure("%s", message) : failure("%.180s: %s", path.c_str(), message);
  char* end = status.message;
  bool space = false;
  for (const char* c = status.message; *c; ++c) {
    bool is_space = static_cast<unsigned char>(*c) <= ' ' || *c == 127;
    if (!is_space) *end++ = *c;
    if (is_space && !space) *end++ = ' ';
    space = is_space;
  }
  *end = 0;
  return status;
}

}  // namespace

std::string import_formats() { return "gltf glb obj ply" + assimp_formats(); }

Status import_scene(const std::string& path, const ImportOptions& options, ImportedScene* result) {
  try {
    import_any(path, options, result);
    return success();
  } catch (const std::bad_alloc&) {
    return one_line_failure(path, "not enough memory to read it; use a smaller model");
  } catch (const std::exception& error) {
    return one_line_failure(path, error.what());
  } catch (...) {
    return one_line_failure(path, "cannot be read; export the file again");
  }
}

}  // namespace pocketray
