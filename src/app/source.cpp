#include "app/source.h"

#include <cstdlib>
#include <cstring>

#include "plan/plan_scene.h"
#include "platform/memory.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"

namespace pocketray {
namespace {

Status load_builtin(const BuiltinScene& builtin, Renderer* r, SceneSource* source, SceneStorage* storage) {
  if (builtin.need() > arena_free(r->scene_arena))
    return scene_too_large(builtin.name, builtin.need(), r->settings.memory_bytes, source);
  builtin.build(&r->scene_arena, &r->scene);
  storage->arena_bytes = r->scene_arena.used;
  return success();
}

Status load_baked(const std::string& name, Renderer* r, SceneSource* source, SceneStorage* storage) {
  platform::FileError error;
  if (!platform::map_file(name.c_str(), &source->mapped, &error)) return failure("%s %s", name.c_str(), error.text);
  source->baked = source->mapped.bytes;
  source->baked_bytes = storage->mapped_bytes = source->mapped.byte_count;
  if (storage->mapped_bytes > r->settings.memory_bytes)
    return scene_too_large(name, storage->mapped_bytes, r->settings.memory_bytes, source);
  Status status = baked_open(source->mapped.bytes, source->mapped.byte_count, &r->scene);
  return status.ok ? status : failure("%s: %.400s", name.c_str(), status.message);
}

#ifdef POCKETRAY_HAVE_IMPORT
Status load_imported(const std::string& name, Renderer* r, SceneSource* source, SceneStorage* storage) {
  ImportedScene imported;
  RETURN_IF_ERROR(import_model(name, ImportOptions(), &imported));
  source->warning = imported.warning;
  // From the heap into the block, in the form a device would map.
  std::size_t size = baked_size(imported.scene);
  auto* bytes = static_cast<std::uint8_t*>(arena_try_allocate(&r->scene_arena, size));
  if (!bytes) return scene_too_large(name, size, r->settings.memory_bytes, source);
  baked_write(imported.scene, bytes);
  source->baked = bytes;
  source->baked_bytes = size;
  storage->arena_bytes = r->scene_arena.used;
  Status status = baked_open(bytes, size, &r->scene);
  return status.ok ? status : failure("%s: %.400s", name.c_str(), status.message);
}
#endif

bool ends_with(const std::string& text, const char* end) {
  std::size_t n = std::strlen(end);
  return text.size() >= n && text.compare(text.size() - n, n, end) == 0;
}

}  // namespace

#ifdef POCKETRAY_HAVE_IMPORT
Status import_model(const std::string& name, const ImportOptions& options, ImportedScene* imported) {
  RETURN_IF_ERROR(import_scene(name, options, imported));
  bool lit = lights_itself(imported->scene);
  imported->scene.info.default_lights = lit ? 0 : 1;
  imported->scene.info.auto_exposure = lit ? 1.0f : 0.0f;
  return success();
}
#endif

void* take_block(std::size_t bytes) {
  void* block = std::malloc(bytes);
  if (block) platform::wish_large_pages(block, bytes);
  return block;
}
void give_block_back(void* block) { std::free(block); }

Status scene_too_large(const std::string& name, std::uint64_t need, std::size_t limit, SceneSource* source) {
  std::uint64_t megabytes = (need >> 20) + (need >> 22) + 4;  // and a quarter for what is made of it
  bool hopeless = megabytes > kMemoryBytesMax >> 20;
  source->bytes_wanted = hopeless ? SIZE_MAX : static_cast<std::size_t>(megabytes << 20);
  double needed = static_cast<double>(need) / (1 << 20), allowed = static_cast<double>(limit) / (1 << 20);
  if (hopeless)
    return failure("%.200s needs %.1f MiB for the scene alone: no --memory holds it", name.c_str(), needed);
  return failure(
      "%.200s needs %.1f MiB for the scene alone and --memory allows %.1f MiB: --memory %lluM would be a start",
      name.c_str(), needed, allowed, static_cast<unsigned long long>(megabytes));
}

bool is_local_scene(const std::string& name) {
  return find_builtin(name.c_str()) || platform::file_stamp(name.c_str()) != 0;
}

Status load_scene(const std::string& name, Renderer* r, SceneSource* source, SceneStorage* storage) {
  *storage = SceneStorage();
  if (const BuiltinScene* builtin = find_builtin(name.c_str())) return load_builtin(*builtin, r, source, storage);
  if (!is_local_scene(name)) {
    std::string names;
    int count;
    const BuiltinScene* list = builtin_list(&count);
    for (int i = 0; i < count; ++i) names += std::string(i ? ", " : "") + list[i].name;
    return failure("%.300s is no file, nor a built-in scene (%s): check the name", name.c_str(), names.c_str());
  }
  if (ends_with(name, ".pray")) return load_baked(name, r, source, storage);
#ifdef POCKETRAY_HAVE_IMPORT
  return load_imported(name, r, source, storage);
#else
  return failure("%s is neither a built-in scene nor a .pray file: bake it on a desktop with `pocketray bake`",
                 name.c_str());
#endif
}

}  // namespace pocketray
