// Front files: per scene, its candidates with their errors, which hold on every machine; per scene and machine, the
// prices measured there.
#pragma once
#include <string>
#include <vector>

#include "plan/front.h"
#include "scene/content_hash.h"

namespace pocketray {

// Path of a scene's front or, if a machine is named, of the scene's prices on it, in its cache_folder(); empty if there
// is none. `scene` as on the command line.
std::string front_path(const std::string& scene, const ContentHash& identity, const std::string& machine = "");
// Name of the machine in price files: device and threads if emulated ("tablet-1"), otherwise instruction set and
// threads ("avx512-2").
std::string machine_name(const char* emulated, std::uint32_t thread_count);

struct CachedFront {
  Front front;                          // count 0: not measured
  Front prices;                         // measured on this machine
  std::string front_path, prices_path;  // empty: nowhere
  std::vector<std::string> notes;       // why a file was ignored
};
// Reads what the cache holds of a scene and this machine, as named by machine_name(). Ignores broken files, with a
// note.
CachedFront read_cached_front(const std::string& scene, const ContentHash& identity, const std::string& machine);

// If there is no such file, succeeds with *there false and *front empty.
Status read_front(const std::string& path, Front* front, bool* there);
// Replaces the file atomically.
Status write_front(const std::string& path, const Front& front);
// Creates the folder of a front_path() if missing, then calls write_front().
Status cache_front(const std::string& path, const Front& front);

}  // namespace pocketray
