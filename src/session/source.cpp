#include "session/source.h"

#include <cstdlib>
#include <vector>

#include "base/check.h"
#include "base/nearest_word.h"
#include "engine/workers.h"
#include "plan/plan_scene.h"
#include "platform/file.h"
#include "platform/memory.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"
#include "scene/texture_side.h"
#include "session/baked_file.h"
#include "session/environment.h"
#ifdef POCKETRAY_HAVE_IMPORT
#include "session/environment_import.h"
#include "session/measured_view.h"
#include "session/studio_fill.h"
#endif

namespace pocketray {
namespace {

Status load_builtin(const BuiltinScene& builtin, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
  if (builtin.need() > arena_free(renderer->memory.scene))
    return scene_too_large(builtin.name, builtin.need(), renderer->settings.memory_bytes, source);
  builtin.build(&renderer->memory.scene, &renderer->scene);
  CHECK_LE(renderer->memory.scene.used, builtin.need());
  storage->arena_bytes = renderer->memory.scene.used;
  return success();
}

// Derived: from this size on, checking a file takes ten times as long as starting a thread, 0.1 ms on a Cortex-A7.
constexpr std::size_t kSharedBytesMin = 4u << 20;

// Opens the file in the scene arena.
Status adopt(const std::string& name, const FittedFile& file, Renderer* renderer, SceneSource* source,
             SceneStorage* storage) {
  CHECK(file.bytes != nullptr);
  source->baked = file.bytes, source->baked_bytes = file.byte_count;
  source->has_all_levels = file.is_whole, source->whole = file.whole;
  renderer->settings.texture_side_max = file.texture_side_max;
  storage->arena_bytes = renderer->memory.scene.used;
  // The threads that render start later, once memory is planned.
  Workers* workers = file.byte_count >= kSharedBytesMin ? start_workers(renderer->settings.threads) : nullptr;
  const Status status = baked_open(file.bytes, file.byte_count, &renderer->scene, loop_over(workers));
  stop_workers(workers);
  return status.ok ? status : failure("%s: %.400s", name.c_str(), status.message);
}

Status load_baked(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
  FittedFile file;
  const Status status = with_file(name, [&](const ByteSource& bytes) {
    source->whole_bytes = bytes.byte_count;
    return read_fitted(bytes, renderer->settings.texture_side_max, &renderer->memory.scene, &file);
  });
  if (!status.ok) return failure("%.300s %s", name.c_str(), status.message);
  if (!file.bytes) return scene_too_large(name, source->whole_bytes, renderer->settings.memory_bytes, source);
  return adopt(name, file, renderer, source, storage);
}

#ifdef POCKETRAY_HAVE_IMPORT
Status load_imported(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
  ImportedScene imported;
  const bool with_studio =
      renderer->view.look.environment == EnvironmentChoice::as_scene && !renderer->view.look.has_background;
  ImportOptions options;
  apply(source->reading, &options);
  options.animations = renderer->view.animation != kNone;
  RETURN_IF_ERROR(import_model(name, options, &imported, with_studio));
  source->warning = imported.warning;
  source->material_names = imported.material_names;
  source->parts = imported.parts;
  source->has_fill = imported.has_fill;
  source->files = imported.files;
  // Copies from the heap into the block, in the form that a device would read.
  const std::size_t size = baked_size(imported.scene);
  source->whole_bytes = size;
  const std::uint32_t side_max = renderer->settings.texture_side_max;
  FittedFile file;
  file.texture_side_max = side_max;
  if (size <= arena_free(renderer->memory.scene) && !any_levels_beyond(imported.scene.textures, side_max)) {
    file.bytes = static_cast<std::uint8_t*>(arena_allocate(&renderer->memory.scene, size)), file.byte_count = size;
    baked_write(imported.scene, file.bytes);
  } else {
    std::vector<std::uint8_t> bytes(size);
    baked_write(imported.scene, bytes.data());
    RETURN_IF_ERROR(read_fitted(bytes_in_memory(bytes.data(), size), side_max, &renderer->memory.scene, &file));
  }
  if (!file.bytes) return scene_too_large(name, size, renderer->settings.memory_bytes, source);
  return adopt(name, file, renderer, source, storage);
}
#endif

}  // namespace

#ifdef POCKETRAY_HAVE_IMPORT
namespace {

struct FurnishedModel {
  std::shared_ptr<void> model;
  EnvironmentMemory studio;
  MeasuredView view;
};

}  // namespace

void apply(const ReadingChoice& choice, ImportOptions* options) {
  CHECK(options != nullptr);
  options->up = choice.up == "z" ? UpAxis::z : choice.up == "y" ? UpAxis::y : UpAxis::of_format;
  options->glass = choice.glass == "thin"    ? GlassKind::thin
                   : choice.glass == "solid" ? GlassKind::solid
                                             : GlassKind::automatic;
  options->strict = choice.strict;
  options->root = choice.root;
}

Status import_model(const std::string& name, const ImportOptions& options, ImportedScene* imported, bool with_studio) {
  RETURN_IF_ERROR(import_scene(name, options, imported));
  bool lit = lights_itself(imported->scene);
  imported->scene.info.default_lights = lit ? 0 : 1;
  imported->scene.info.auto_exposure = lit ? 1.0f : 0.0f;
  auto storage = std::make_shared<FurnishedModel>();
  storage->model = imported->storage;
  if (!lit && with_studio && calls_for_studio(imported->scene))
    RETURN_IF_ERROR(set_environment(kStudio, &imported->scene, &storage->studio));
  if (lit && with_studio && calls_for_fill(imported->scene)) {
    const double radiance = typical_radiance(imported->scene);
    RETURN_IF_ERROR(set_environment(kStudio, &imported->scene, &storage->studio));
    dim_to_fill(radiance, storage->studio.info.data(), &imported->scene.info.background);
    imported->has_fill = true;
    imported->scene.info.auto_exposure = 2;  // a wide backdrop would call for more than the lights' share
  }
  if (needs_view(imported->scene)) measure_view(&imported->scene, &storage->view);
  imported->storage = storage;
  return success();
}
#endif

void* take_block(std::size_t bytes) {
  CHECK_GT(bytes, 0u);
  void* block = std::malloc(bytes);
  if (block) platform::wish_large_pages(block, bytes);
  return block;
}
void give_block_back(void* block) { std::free(block); }

bool is_baked_name(const std::string& name) {
  const std::string end = ".pray";
  return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

Status read_baked(const std::string& path, const std::function<std::uint8_t*(std::uint64_t byte_count)>& take,
                  std::uint8_t** bytes, std::uint64_t* byte_count) {
  platform::FileReader file;
  platform::FileError error;
  if (!platform::open_reader(path.c_str(), &file, &error)) return failure("%s", error.text);
  CHECK(take != nullptr && bytes != nullptr && byte_count != nullptr);
  *byte_count = file.byte_count;
  *bytes = take(file.byte_count);
  bool ok = *bytes != nullptr;
  if (!ok)
    std::snprintf(error.text, sizeof error.text, "has %llu bytes: not enough memory",
                  static_cast<unsigned long long>(file.byte_count));
  ok = ok && platform::read_bytes(&file, *bytes, static_cast<std::size_t>(file.byte_count), &error);
  platform::close_reader(&file);
  return ok ? success() : failure("%s", error.text);
}

Status hash_file(const std::string& path, ContentHash* hash) {
  CHECK(hash != nullptr);
  platform::FileReader file;
  platform::FileError error;
  if (!platform::open_reader(path.c_str(), &file, &error)) return failure("%.300s %s", path.c_str(), error.text);
  std::vector<std::uint8_t> part(1u << 16);
  ContentHasher hasher;
  bool ok = true;
  for (std::uint64_t left = file.byte_count; ok && left > 0;) {
    std::size_t count = left < part.size() ? static_cast<std::size_t>(left) : part.size();
    ok = platform::read_bytes(&file, part.data(), count, &error);
    if (ok) hash_part(&hasher, part.data(), count);
    left -= count;
  }
  platform::close_reader(&file);
  *hash = hash_end(hasher);
  return ok ? success() : failure("%.300s %s", path.c_str(), error.text);
}

Status scene_too_large(const std::string& name, std::uint64_t need, std::size_t limit, SceneSource* source) {
  CHECK(source != nullptr);
  std::uint64_t megabytes = (need >> 20) + (need >> 22) + 4;  // plus a quarter for data derived from it
  bool hopeless = megabytes > kMemoryBytesMax >> 20;
  source->bytes_wanted = hopeless ? SIZE_MAX : static_cast<std::size_t>(megabytes << 20);
  double needed = static_cast<double>(need) / (1 << 20), allowed = static_cast<double>(limit) / (1 << 20);
  if (hopeless)
    return failure("%.200s needs %.1f MiB for the scene alone, more than --memory can be", name.c_str(), needed);
  return failure("%.200s needs %.2f MiB for the scene alone but --memory allows %.2f MiB: try --memory %lluM",
                 name.c_str(), needed, allowed, static_cast<unsigned long long>(megabytes));
}

bool is_local_scene(const std::string& name) {
  return find_builtin(name.c_str()) || platform::file_stamp(name.c_str()) != 0;
}

Status unknown_scene(const std::string& name) {
  std::string names;
  NearestWord nearest(name.c_str());
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    names += std::string(i ? ", " : "") + list[i].name;
    nearest.offer(list[i].name);
  }
  if (nearest.name())
    return failure("there is no scene or file %.300s, did you mean '%s'?", name.c_str(), nearest.name());
  return failure("%.300s is neither a file nor a built-in scene (%s): check the name", name.c_str(), names.c_str());
}

Status load_scene(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr);
  *storage = SceneStorage();
  if (const BuiltinScene* builtin = find_builtin(name.c_str()))
    return load_builtin(*builtin, renderer, source, storage);
  if (!is_local_scene(name)) return unknown_scene(name);
  if (is_baked_name(name)) return load_baked(name, renderer, source, storage);
#ifdef POCKETRAY_HAVE_IMPORT
  return load_imported(name, renderer, source, storage);
#else
  return failure("%s is neither a built-in scene nor a .pray file: bake it on a desktop with `pocketray bake`",
                 name.c_str());
#endif
}

}  // namespace pocketray
