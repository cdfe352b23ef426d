// Radiosity solved for a scene, in the cache.
#pragma once
#include "scene/content_hash.h"
#include "session/radiosity.h"

namespace pocketray {

// Path of a scene's light in its cache_folder(); empty if there is none. `identity`: of the scene without radiosity.
std::string light_path(const std::string& scene, const ContentHash& identity);

enum class KeptLight { none, unfit, solved };  // unfit: no solution stays within the limit
// Reads what the cache keeps and, if solved, makes *scene refer to arrays in *memory, checked like a .pray file's.
// Broken files, and those of other versions of the program, are none.
KeptLight read_light(const std::string& path, const ContentHash& identity, Scene* scene, SolvedRadiosity* memory);
// Replaces the file atomically with the scene's radiosity, or with the fact that none fits.
Status write_light(const std::string& path, const ContentHash& identity, const Scene& scene);

}  // namespace pocketray
