#include "import/import.h"

#include <cstring>
#include <exception>
#include <new>

#include "import/assimp.h"
#include "import/files.h"
#include "import/gltf.h"
#include "import/import_error.h"
#include "import/obj.h"
#include "import/scene_builder.h"

namespace pocketray {
namespace {

bool is_gltf(const std::string& ending, const Bytes& bytes) {
  return ending == "gltf" || ending == "glb" || (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0);
}

void import_any(const std::string& path, SceneBuilder* builder) {
  std::string ending = path_ending(path);
  Bytes bytes = read_file(path, builder->options.byte_count_max);
  if (bytes.empty()) fail_import("the file is empty");
  if (is_gltf(ending, bytes)) return import_gltf(path, std::move(bytes), builder);
  if (ending == "obj") return import_obj(path, bytes, builder);
  if (assimp_reads(ending)) return import_assimp(path, ending, bytes, builder);
  fail_import("no reader for '.%.20s' files; convert to one of: %s", ending.c_str(), import_formats().c_str());
}

// Libraries put line feeds and worse into their messages; a Status is one line.
Status one_line_failure(const std::string& path, const char* message) {
  Status status = failure("%.180s: %s", path.c_str(), message);
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

std::string import_formats() { return "gltf glb obj" + assimp_formats(); }

Status import_scene(const std::string& path, const ImportOptions& options, ImportedScene* result) {
  try {
    SceneBuilder builder;
    builder.options = options;
    import_any(path, &builder);
    finish_scene(&builder, path_stem(path), result);
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
