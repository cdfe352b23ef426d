#include "session/environment.h"

#include <cstring>

#include "base/check.h"
#include "base/nearest_word.h"
#include "plan/plan_scene.h"
#include "platform/file.h"
#include "session/note.h"
#include "session/radiosity.h"
#include "session/scene_options.h"
#ifdef POCKETRAY_HAVE_IMPORT
#include "session/environment_import.h"
#endif

namespace pocketray {

#ifdef POCKETRAY_HAVE_IMPORT
namespace {

Status read_named_environment(const std::string& name, ImportedEnvironment* read) {
  NearestWord nearest(name.c_str());
  for (const char* word : {"sky", kStudio, kNoEnvironment}) nearest.offer(word);
  const bool is_word = name.find('.') == std::string::npos && platform::file_stamp(name.c_str()) == 0;
  if (is_word && nearest.name() && name != nearest.name())
    return failure("--environment is '%.60s', did you mean '%s'?", name.c_str(), nearest.name());
  const Status status = read_environment(name, read);
  return status.ok || std::strstr(status.message, "--environment") ? status
                                                                   : failure("--environment: %.480s", status.message);
}

}  // namespace

Status set_environment(const std::string& name, Scene* scene, EnvironmentMemory* memory) {
  CHECK(scene != nullptr && memory != nullptr);
  if (!scene->radiosity_info.empty())
    return failure("the scene stores radiosity, solved for other surroundings: bake it again with --environment");
  const bool wants_lights = scene->info.default_lights != 0 || !has_light(*scene);
  ImportedEnvironment read;
  RETURN_IF_ERROR(read_named_environment(name, &read));
  if (scene->lights.count + read.lights.size() > kLightCountMax)
    return failure("the scene has %u lights, with the environment's %zu they are more than %u: use fewer",
                   scene->lights.count, read.lights.size(), kLightCountMax);
  memory->info = {read.info};
  memory->file = read.file;
  memory->texels = std::move(read.texels);
  memory->lights.assign(scene->lights.begin(), scene->lights.end());
  memory->lights.insert(memory->lights.end(), read.lights.begin(), read.lights.end());
  scene->environment_info = {memory->info.data(), 1};
  scene->environment_texels = {memory->texels.data(), static_cast<std::uint32_t>(memory->texels.size())};
  for (EnvironmentSun& sun : read.suns) sun.light += scene->lights.count;
  memory->suns = read.suns;
  scene->environment_suns = {memory->suns.data(), static_cast<std::uint32_t>(memory->suns.size())};
  scene->lights = {memory->lights.data(), static_cast<std::uint32_t>(memory->lights.size())};
  scene->info.background = read.mean;
  scene->info.ambient = {0, 0, 0};
  scene->info.default_lights = read.is_studio && wants_lights ? 1 : 0;
  return success();
}
#else
Status set_environment(const std::string& name, Scene*, EnvironmentMemory*) {
  return failure("--environment %.200s cannot be read by this build: bake the scene with it on a desktop",
                 name.c_str());
}
#endif

Status set_environment_if_requested(const std::string& name, Renderer* renderer, SceneSource* source,
                                    SceneStorage* storage) {
  if (name.empty() || name == kNoEnvironment) return success();
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr);
  Scene* scene = &renderer->scene;
  if (!scene->radiosity_info.empty() && renderer->settings.indirect == IndirectChoice::automatic) {
    print_note("leaving out the scene's stored light between surfaces, which is of other surroundings");
    drop_radiosity(scene);
    source->baked = nullptr, source->baked_bytes = 0;  // it is no longer the file's scene
  }
  EnvironmentMemory memory;
  RETURN_IF_ERROR(set_environment(name, scene, &memory));
  if (!memory.file.empty()) source->files.push_back(memory.file);
  const std::size_t bytes = arena_need<EnvironmentInfo>(1) + arena_need<std::uint32_t>(memory.texels.size()) +
                            arena_need<Light>(memory.lights.size()) + arena_need<EnvironmentSun>(memory.suns.size());
  Arena* arena = &renderer->memory.scene;
  if (bytes > arena_free(*arena))
    return scene_too_large(name, arena->used + bytes, renderer->settings.memory_bytes, source);
  auto keep = [arena](auto& array) {
    if (array.empty()) return;
    void* copy = arena_allocate(arena, array.bytes());
    std::memcpy(copy, array.data, array.bytes());
    array.data = static_cast<decltype(array.data)>(copy);
  };
  keep(scene->environment_info), keep(scene->environment_texels), keep(scene->lights);
  keep(scene->environment_suns);
  const ContentHash parts[2] = {
      source->has_all_levels ? content_hash(source->baked, source->baked_bytes) : source->whole,
      content_hash(scene->environment_texels.data, scene->environment_texels.bytes())};
  source->environment = content_hash(parts, sizeof parts);
  source->baked = nullptr, source->baked_bytes = 0;  // it is no longer the file's scene
  storage->arena_bytes = arena->used;
  return success();
}

}  // namespace pocketray
