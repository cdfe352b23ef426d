// Loads a scene: a built-in one, a .pray file used as it is, or any format that import/ reads.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/renderer.h"
#include "scene/content_hash.h"
#ifdef POCKETRAY_HAVE_IMPORT
#include "import/import.h"
#endif

namespace pocketray {

using NamedBoxes = std::vector<std::pair<std::string, Box>>;

// How a model is read; see ImportOptions.
struct ReadingChoice {
  std::string up;  // y or z; empty: as its format has it
  bool strict = false;
  std::string root;  // the folder that the model's files lie below; empty: its own
};

struct SceneSource {
  ReadingChoice reading;                // set before loading
  const std::uint8_t* baked = nullptr;  // the .pray file, or what a model became, that the scene is a view of; null: a
  std::size_t baked_bytes = 0;          // built-in scene
  ContentHash environment;              // of what --environment made of the scene; zero: it has its own
  std::string warning;                  // one line; empty: none
  std::vector<std::string> material_names;  // of the scene's materials, as far as the file has them
  std::vector<std::string> files;           // that a model and its environment were read from
  NamedBoxes parts;              // named parts of a model and their bounds at time 0; names may occur more than once
  Box focus = empty_box();       // bounds of the part that --focus names; empty: none
  std::size_t bytes_wanted = 0;  // memory needed, if loading failed for lack of it; else 0
};

// Takes the one memory block, kept while its scene is open. Null if the system refuses.
void* take_block(std::size_t bytes);
void give_block_back(void* block);

#ifdef POCKETRAY_HAVE_IMPORT
void apply(const ReadingChoice& choice, ImportOptions* options);

// Imports a model and decides its light. A model with lights gets its exposure measured, since files' units vary beyond
// a display's range; others ask for the default lights, and get a studio `with_studio` if they call for it.
Status import_model(const std::string& name, const ImportOptions& options, ImportedScene* imported,
                    bool with_studio = true);
#endif

// The error for a scene that needs more than `limit` bytes; stores the memory it needs in *source.
Status scene_too_large(const std::string& name, std::uint64_t need, std::size_t limit, SceneSource* source);
// True if `name` is a built-in scene or a file.
bool is_local_scene(const std::string& name);

// Reads a .pray file into memory from `take(byte_count)`, aligned to 64 bytes, which may return null. The checked bytes
// are the used bytes: later writes to the file do not matter. Sets byte_count if the file could be opened.
Status read_baked(const std::string& path, const std::function<std::uint8_t*(std::uint64_t byte_count)>& take,
                  std::uint8_t** bytes, std::uint64_t* byte_count);
// Hashes a file without loading it whole.
Status hash_file(const std::string& path, ContentHash* hash);
// True if the name ends in .pray.
bool is_baked_name(const std::string& name);

// Loads the scene `name` into renderer->scene, with its arrays in the scene arena.
Status load_scene(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
