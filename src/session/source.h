// Loads a scene: a built-in one, a .pray file used as it is, or any format that desktop/import/ reads.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/renderer.h"
#include "scene/content_hash.h"
#include "session/model_import.h"

namespace pocketray {

// How to read a model; see ImportOptions.
struct ReadingChoice {
  std::string up;     // y or z; empty: by its format
  std::string glass;  // auto, thin or solid; empty: auto
  bool strict = false;
  std::string root;  // folder that must contain the model's files; empty: its own
};

struct SceneSource {
  ReadingChoice reading;                // set before loading
  const std::uint8_t* baked = nullptr;  // the .pray file or baked model that the scene views; null: built-in
  std::size_t baked_bytes = 0;
  bool has_all_levels = true;               // false: larger levels of textures are left out of these bytes,
  ContentHash whole;                        // and with them they have this hash,
  std::uint64_t whole_bytes = 0;            // and size
  ContentHash environment;                  // of the scene as --environment made it; zero: its own
  std::string warning;                      // one line; empty: none
  std::vector<std::string> material_names;  // of the scene's materials, as far as the file has them
  std::vector<std::string> files;           // files of the model and its environment
  NamedBoxes parts;                         // named parts of a model and their bounds at time 0; names may repeat
  bool has_fill = false;                    // a dimmed studio came with the model's own lights
  Box focus = empty_box();                  // bounds of the part that --focus names; empty: none
  bool lit_unasked = false;                 // its radiosity comes from light_room()
  std::size_t bytes_wanted = 0;             // memory needed, if loading failed for lack of it; otherwise 0
};

// Takes the single memory block, kept while its scene is open. Returns null if the system refuses.
void* take_block(std::size_t bytes);
void give_block_back(void* block);

#ifdef POCKETRAY_HAVE_IMPORT
void apply(const ReadingChoice& choice, ImportOptions* options);

// Imports a model and decides its light. A model with lights gets its exposure measured, since files' units vary beyond
// a display's range; others get the default lights and, with `with_studio`, a studio if they call for it, or to fill
// their own lights' shadows (session/studio_fill.h).
Status import_model(const std::string& name, const ImportOptions& options, ImportedScene* imported,
                    bool with_studio = true);
#endif

// Returns the error for a scene that needs more than `limit` bytes; stores the memory it needs in *source.
Status scene_too_large(const std::string& name, std::uint64_t need, std::size_t limit, SceneSource* source);
// Returns the error for a name that is neither a built-in scene nor a file.
Status unknown_scene(const std::string& name);
// True if `name` is a built-in scene or a file.
bool is_local_scene(const std::string& name);

// Reads a .pray file into memory from `take(byte_count)`, aligned to 64 bytes, which may return null. Uses exactly the
// bytes that it checked: later writes to the file do not matter. Sets byte_count if the file could be opened.
Status read_baked(const std::string& path, const std::function<std::uint8_t*(std::uint64_t byte_count)>& take,
                  std::uint8_t** bytes, std::uint64_t* byte_count);
// Hashes a file without loading it completely.
Status hash_file(const std::string& path, ContentHash* hash);
// True if the name ends in .pray.
bool is_baked_name(const std::string& name);

// Loads the scene `name` into renderer->scene, with its arrays in the scene arena.
Status load_scene(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
