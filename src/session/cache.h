// Location of expensive results that are kept between runs.
#pragma once
#include <string>

#include "base/status.h"

namespace pocketray {

// Returns $XDG_CACHE_HOME/pocketray, otherwise ~/.cache/pocketray, otherwise the folder of the scene's file; empty for
// a built-in scene without a cache. `scene` as on the command line.
std::string cache_folder(const std::string& scene);
// Creates the folder of the file if missing; fails if the file cannot be written. `option` names it in messages.
Status make_cache(const std::string& path, const char* option);

}  // namespace pocketray
