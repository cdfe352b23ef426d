// Scenes made by code: the first thing people see, and the scenes behind all published figures.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

struct BuiltinScene {
  const char* name;
  const char* description;  // one line, for --help
  std::size_t (*need)();    // bytes build() takes from the arena
  void (*build)(Arena* arena, Scene* scene);
};

// All built-in scenes; sets *count to their number.
const BuiltinScene* builtin_list(int* count);
// Returns null if no scene has that name.
const BuiltinScene* find_builtin(const char* name);

// `cornell` with a mirror sphere of `columns` columns, at least 4: shows the cost and gain of tessellation.
constexpr std::uint32_t kCornellSphereColumns = 64;  // as in `cornell` itself
std::size_t tessellated_cornell_need(std::uint32_t sphere_columns);
void build_tessellated_cornell(std::uint32_t sphere_columns, Arena* arena, Scene* scene);

}  // namespace pocketray
