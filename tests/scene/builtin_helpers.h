// A built-in scene in its own memory, for the tests of src/scene/builtin.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/builtin/builtin.h"

namespace pocketray {

struct BuiltScene {
  std::vector<std::uint8_t> block;
  Arena arena;
  Scene scene;
};

inline std::unique_ptr<BuiltScene> build_builtin(const BuiltinScene& builtin) {
  auto built = std::make_unique<BuiltScene>();
  built->block.resize(builtin.need() + kArenaAlignment);
  built->arena = make_arena(builtin.name, built->block.data(), built->block.size());
  builtin.build(&built->arena, &built->scene);
  return built;
}
inline std::unique_ptr<BuiltScene> build_builtin(const char* name) { return build_builtin(*find_builtin(name)); }

// The same, built once for all tests of a program: an emulated CPU without an FPU takes seconds to build a scene.
inline const BuiltScene* shared_builtin(const BuiltinScene& builtin) {
  static std::map<std::string, std::unique_ptr<BuiltScene>> scenes;
  std::unique_ptr<BuiltScene>& built = scenes[builtin.name];
  if (!built) built = build_builtin(builtin);
  return built.get();
}
inline const BuiltScene* shared_builtin(const char* name) { return shared_builtin(*find_builtin(name)); }

}  // namespace pocketray
