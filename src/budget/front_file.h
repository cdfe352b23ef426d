// Where fronts are kept: per scene what there is to choose from, with its errors, which hold on every machine; per
// scene and machine the prices measured there.
#pragma once
#include <string>

#include "plan/front.h"
#include "scene/content_hash.h"

namespace pocketray {

// The file of a scene's front, or, where a machine is named, of the scene's prices on it: in $XDG_CACHE_HOME/pocketray,
// else in ~/.cache/pocketray, else beside the scene's file; empty for a built-in scene where there is none of these.
// `scene` as on the command line.
std::string front_path(const std::string& scene, const ContentHash& identity, const std::string& machine = "");
// The machine as prices know it: "tablet-1" where one is emulated, else instruction set and threads: "avx512-2".
std::string machine_name(const char* emulated, std::uint32_t thread_count);

// *there is false, and *front empty, where there is no such file.
Status read_front(const std::string& path, Front* front, bool* there);
// Replaces the file as a whole or not at all.
Status write_front(const std::string& path, const Front& front);
// Makes the folder of a front_path() where there is none; fails where the file cannot be written.
Status make_cache(const std::string& path);
// Both.
Status cache_front(const std::string& path, const Front& front);

}  // namespace pocketray
