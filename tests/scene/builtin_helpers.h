// A built-in scene in its own memory, for the tests of src/scene/builtin.
#pragma once
#include <memory>
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

}  // namespace pocketray
