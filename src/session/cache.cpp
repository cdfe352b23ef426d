#include "session/cache.h"

#include <cstdlib>

#include "platform/file.h"
#include "scene/builtin/builtin.h"
#include "session/output.h"

namespace pocketray {
namespace {

std::string folder_of(const std::string& path) {
  std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash);
}

}  // namespace

std::string cache_folder(const std::string& scene) {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache && *cache == '/')
    return std::string(cache) + "/pocketray";  // the XDG specification says to ignore relative paths
  const char* home = std::getenv("HOME");
  if (home && *home == '/') return std::string(home) + "/.cache/pocketray";
  return find_builtin(scene.c_str()) ? "" : folder_of(scene);
}

Status make_cache(const std::string& path, const char* option) {
  platform::FileError error;
  std::string folder = folder_of(path) + "/";
  for (std::size_t at = folder.find('/', 1); at != std::string::npos; at = folder.find('/', at + 1))
    if (platform::file_stamp(folder.substr(0, at).c_str()) == 0)
      (void)platform::make_folder(folder.substr(0, at).c_str(), &error);
  if (platform::is_device_or_pipe(path.c_str()))  // nobody chose it
    return failure("%.300s is a pipe or a device, where %s keeps what it measured: remove it", path.c_str(), option);
  return check_outputs({}, {{option, path}});
}

}  // namespace pocketray
