// Where a scene comes from: a built-in name, a .pray file used as it is read, or any format that import/ reads.
#pragma once
#include <functional>
#include <string>

#include "engine/renderer.h"
#include "scene/content_hash.h"
#ifdef POCKETRAY_HAVE_IMPORT
#include "import/import.h"
#endif

namespace pocketray {

struct SceneSource {
  const std::uint8_t* baked = nullptr;  // the .pray file, or what a model became, that the scene is a view of; null: a
  std::size_t baked_bytes = 0;          // built-in scene
  std::string warning;                  // one line, empty if there is nothing to say
  std::size_t bytes_wanted = 0;         // of memory, where it failed for want of that; 0: it did not
};

// The one block, taken at start and kept as long as its scene is open. Null when it cannot be had.
void* take_block(std::size_t bytes);
void give_block_back(void* block);

#ifdef POCKETRAY_HAVE_IMPORT
// Imports a model and settles its light: one that lights itself is exposed by measurement, since the units of files
// vary beyond what a display shows; any other asks for the stated lights.
Status import_model(const std::string& name, const ImportOptions& options, ImportedScene* imported);
#endif

// The error of a scene that needs so many bytes where fewer are allowed; notes what would hold it.
Status scene_too_large(const std::string& name, std::uint64_t need, std::size_t limit, SceneSource* source);
// Whether `name` is a built-in scene or a file.
bool is_local_scene(const std::string& name);

// Reads a .pray file into memory of `take(byte_count)`, aligned to 64, which returns null where there is none. What is
// checked there is what will be used: whoever writes to the file later does not change it. byte_count is set where the
// file could be opened.
Status read_baked(const std::string& path, const std::function<std::uint8_t*(std::uint64_t byte_count)>& take,
                  std::uint8_t** bytes, std::uint64_t* byte_count);
// The hash of a file's bytes, without memory for all of them.
Status hash_file(const std::string& path, ContentHash* hash);
// Whether a scene's name is that of a .pray file.
bool is_baked_name(const std::string& name);

// Puts the scene called `name` into renderer->scene; its arrays lie in the scene arena.
Status load_scene(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
