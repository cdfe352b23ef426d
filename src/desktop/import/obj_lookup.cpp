#include "desktop/import/obj_lookup.h"

#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

bool try_beside(const std::vector<std::string>& bases, const std::string& name, std::uint64_t byte_count_max,
                FilesRead* files, Bytes* bytes, std::string* path, std::string* error) {
  for (const std::string& base : bases) try {
      *bytes = read_beside(base, name, byte_count_max, files);
      *path = find_beside(base, name);
      return true;
    } catch (const ImportError& failure) {
      if (error->empty()) *error = failure.what();
    }
  return false;
}

}  // namespace

Bytes read_named(const std::vector<std::string>& bases, const std::string& name, std::uint64_t byte_count_max,
                 SceneBuilder* builder, std::string* path) {
  Bytes bytes;
  std::string error;
  if (try_beside(bases, name, byte_count_max, &builder->files, &bytes, path, &error)) return bytes;
  const std::size_t slash = name.find_last_of("/\\:");
  const std::string last = slash == name.npos ? "" : name.substr(slash + 1);
  if (!last.empty() && try_beside(bases, last, byte_count_max, &builder->files, &bytes, path, &error)) {
    note_remark(builder, "files in missing folders are read from beside the model instead");
    return bytes;
  }
  fail_import("%s", error.c_str());
}

}  // namespace pocketray
