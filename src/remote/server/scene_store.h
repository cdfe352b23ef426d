// The scenes of a render server: all built-in ones and the files of a folder, each as a baked file for all clients.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/content_hash.h"
#include "scene/scene.h"
#include "wire/message.h"

namespace pocketray {

struct StoredScene {
  ContentHash hash;
  char name[kNameBytes] = {0};          // the built-in scene's or the file's, for display
  const std::uint8_t* bytes = nullptr;  // the baked file, a copy
  std::size_t byte_count = 0;
  Scene scene;                  // a view of it, with our accelerator if it has none
  std::size_t accel_bytes = 0;  // size of our accelerator
  void* baked_block = nullptr;
  void* accel_block = nullptr;
};

struct SceneStore {
  std::vector<StoredScene> scenes;
  std::vector<std::string> warnings;  // one line per skipped file
  SceneStore() = default;
  SceneStore(const SceneStore&) = delete;
  SceneStore& operator=(const SceneStore&) = delete;
  ~SceneStore();
};

struct SceneStoreOptions {
  std::string folder;                                // empty: only the built-in scenes
  std::uint64_t bytes_max = std::uint64_t(1) << 30;  // for all scenes with their accelerators; further ones are skipped
  bool lights_rooms = false;                         // as for store_scene()
};

// Reads the scenes, showing progress if that takes long. Fails if the folder is unreadable or memory is short. Ignores
// files that are not scenes; skips unreadable ones with a warning.
Status open_scene_store(const SceneStoreOptions& options, SceneStore* store);

// Adds a scene called `name`: a built-in one, or the file at `path`; at most `bytes_left` with its accelerator. Does
// not add a scene twice. `lights_rooms`: a room is added twice, as desktops open it, with radiosity, and as devices do,
// without.
Status store_scene(const std::string& name, const std::string& path, bool lights_rooms, std::uint64_t bytes_left,
                   SceneStore* store);

// store_scene() for the bytes of a baked file, which are copied.
Status store_baked_scene(const std::string& name, const std::uint8_t* bytes, std::size_t byte_count,
                         std::uint64_t bytes_left, SceneStore* store);

// Total bytes of all scenes with their accelerators.
std::uint64_t stored_bytes(const SceneStore& store);

// Returns null if there is none.
const StoredScene* find_scene(const SceneStore& store, const ContentHash& hash);

}  // namespace pocketray
