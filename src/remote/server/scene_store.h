// The scenes of a render server: all built-in ones and the files of a folder, each as its baked file, ready to be
// shared by all clients and sent to them.
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
  char name[kNameBytes] = {0};          // the built-in scene's or the file's, for people
  const std::uint8_t* bytes = nullptr;  // the baked file, a copy
  std::size_t byte_count = 0;
  Scene scene;                  // a view of it, with an accelerator of ours where it brings none
  std::size_t accel_bytes = 0;  // of ours
  void* baked_block = nullptr;
  void* accel_block = nullptr;
};

struct SceneStore {
  std::vector<StoredScene> scenes;
  std::vector<std::string> warnings;  // a line for each file that was left out
  SceneStore() = default;
  SceneStore(const SceneStore&) = delete;
  SceneStore& operator=(const SceneStore&) = delete;
  ~SceneStore();
};

struct SceneStoreOptions {
  std::string folder;                                // empty: the built-in scenes alone
  std::uint64_t bytes_max = std::uint64_t(1) << 30;  // of all scenes with their accelerators; more are left out
};

// Reads the scenes; shows progress where that takes long. Fails where the folder cannot be read or memory is short. A
// file that is no scene is passed over; one that cannot be read is left out with a warning.
Status open_scene_store(const SceneStoreOptions& options, SceneStore* store);

// Adds one scene, called `name`: a built-in one's name or a file at `path`, of `bytes_left` at most with its
// accelerator. One that the store has already is added no second time.
Status store_scene(const std::string& name, const std::string& path, std::uint64_t bytes_left, SceneStore* store);

// Null: there is none.
const StoredScene* find_scene(const SceneStore& store, const ContentHash& hash);

}  // namespace pocketray
