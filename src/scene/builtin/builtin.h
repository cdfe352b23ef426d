// Scenes made by code: what people see first and what every figure is quoted on.
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

// All built-in scenes; *count is set to how many.
const BuiltinScene* builtin_list(int* count);
// Null if there is none of that name.
const BuiltinScene* find_builtin(const char* name);

// `cornell` with a mirror sphere of so many columns, at least 4: what tessellation costs and gains.
constexpr std::uint32_t kCornellSphereColumns = 64;  // of `cornell` itself
std::size_t tessellated_cornell_need(std::uint32_t sphere_columns);
void build_tessellated_cornell(std::uint32_t sphere_columns, Arena* arena, Scene* scene);

}  // namespace pocketray
