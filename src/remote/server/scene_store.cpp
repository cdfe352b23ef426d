#include "remote/server/scene_store.h"

#include <algorithm>
#include <cstring>
#include <thread>

#include "base/check.h"
#include "base/printable.h"
#include "platform/file.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"
#include "session/heap_scene.h"
#include "session/output.h"
#include "session/progress.h"
#include "session/room_light.h"

namespace pocketray {
namespace {

// True for the name of a scene file; other files are textures and the like.
bool is_scene_file(const std::string& name) {
  if (has_suffix(name.c_str(), ".pray")) return true;
#ifdef POCKETRAY_HAVE_IMPORT
  std::string formats = import_formats() + " ";
  for (std::size_t begin = 0, end; (end = formats.find(' ', begin)) != std::string::npos; begin = end + 1)
    if (end > begin && has_suffix(name.c_str(), ("." + formats.substr(begin, end - begin)).c_str())) return true;
#endif
  return false;
}

void release(StoredScene* stored) {
  give_block_back(stored->baked_block);
  give_block_back(stored->accel_block);
  stored->baked_block = stored->accel_block = nullptr;
}

// Allocates `byte_count` bytes with the alignment of a baked file.
std::uint8_t* take_aligned(std::uint64_t byte_count, void** block) {
  if (byte_count > kMemoryBytesMax) return nullptr;
  *block = take_block(arena_need(byte_count) + kArenaAlignment);
  if (!*block) return nullptr;
  Arena arena = make_arena("scene", *block, arena_need(byte_count) + kArenaAlignment);
  return static_cast<std::uint8_t*>(arena_allocate(&arena, byte_count));
}

Status too_many_bytes(std::uint64_t bytes_max) {
  return failure("it does not fit in the %.0f MiB for all scenes", static_cast<double>(bytes_max) / (1 << 20));
}

// Bakes a scene into memory.
Status write_bytes(const Scene& scene, std::uint64_t bytes_left, StoredScene* stored) {
  CHECK(stored != nullptr);
  const std::size_t byte_count = baked_size(scene);
  if (byte_count > bytes_left) return too_many_bytes(bytes_left);
  std::uint8_t* bytes = take_aligned(byte_count, &stored->baked_block);
  if (!bytes) return failure("cannot get %zu bytes of memory", byte_count);
  baked_write(scene, bytes);
  stored->bytes = bytes;
  stored->byte_count = byte_count;
  return success();
}

// Reads or creates the baked bytes.
Status read_bytes(const std::string& path, std::uint64_t bytes_left, StoredScene* stored) {
  if (is_baked_name(path)) {
    // A copy: writing to or truncating the file while it is served does not affect clients or threads.
    auto take = [&](std::uint64_t byte_count) -> std::uint8_t* {
      return byte_count <= bytes_left ? take_aligned(byte_count, &stored->baked_block) : nullptr;
    };
    std::uint8_t* bytes = nullptr;
    std::uint64_t byte_count = 0;
    Status status = read_baked(path, take, &bytes, &byte_count);
    if (byte_count > bytes_left) return too_many_bytes(bytes_left);
    stored->bytes = bytes;
    stored->byte_count = bytes ? static_cast<std::size_t>(byte_count) : 0;
    return status;
  }
  HeapScene heap;
  RETURN_IF_ERROR(read_heap_scene(path, ModelOptions(), &heap));
  return write_bytes(heap.scene, bytes_left, stored);
}

// Opens the bytes.
Status open_stored(std::uint64_t bytes_left, StoredScene* stored) {
  if (stored->byte_count > bytes_left) return too_many_bytes(bytes_left);
  RETURN_IF_ERROR(baked_open(stored->bytes, stored->byte_count, &stored->scene));
  stored->hash = content_hash(stored->bytes, stored->byte_count);
  if (!stored->scene.accel.empty()) return success();
  Array<const std::uint8_t> accel;
  stored->accel_block = build_heap_accel(kBvhAccel, stored->scene, &accel);
  if (!stored->accel_block) return failure("not enough memory for its accelerator");
  stored->scene.accel = accel;
  stored->accel_bytes = accel.bytes();
  if (stored->byte_count + stored->accel_bytes > bytes_left) return too_many_bytes(bytes_left);
  return success();
}

// Truncates at a UTF-8 character. Clients print it, so control characters are removed.
void set_name(const std::string& name, StoredScene* stored) {
  std::size_t length = std::min(name.size(), std::size_t(kNameBytes - 1));
  while (length > 0 && length < name.size() && (name[length] & 0xC0) == 0x80) --length;
  CHECK_LT(length, sizeof stored->name);
  std::memcpy(stored->name, name.data(), length);
  make_printable(stored->name, length);
}

// Adds an opened scene, or frees its memory.
Status add_scene(const std::string& name, Status status, StoredScene* stored, SceneStore* store) {
  if (status.ok && store->scenes.size() == UINT16_MAX) status = failure("a server holds at most 65535 scenes");
  if (status.ok && !find_scene(*store, stored->hash)) {
    set_name(name, stored);
    store->scenes.push_back(*stored);
  } else {
    release(stored);
  }
  return status;
}

// Adds a room with its radiosity, as desktops open it, if there is memory for it besides `plain`, as devices do.
Status store_lit(const std::string& name, const std::string& path, const StoredScene& plain, std::uint64_t bytes_left,
                 SceneStore* store, bool* is_lit) {
  CHECK(store != nullptr && is_lit != nullptr);
  if (!calls_for_radiosity(plain.scene)) return success();
  Scene scene = plain.scene;
  scene.accel = {};
  SolvedRadiosity solved;
  RETURN_IF_ERROR(find_room_light(path, plain.hash, std::thread::hardware_concurrency(), SIZE_MAX, &scene, &solved));
  if (scene.radiosity_triangles.empty()) return success();
  const std::uint64_t plain_bytes = plain.byte_count + plain.accel_bytes;
  StoredScene lit;
  Status status = write_bytes(scene, bytes_left - plain_bytes, &lit);
  if (status.ok) status = open_stored(bytes_left - plain_bytes, &lit);
  *is_lit = add_scene(name, status, &lit, store).ok;
  return success();
}

}  // namespace

std::uint64_t stored_bytes(const SceneStore& store) {
  std::uint64_t sum = 0;
  for (const StoredScene& stored : store.scenes) sum += stored.byte_count + stored.accel_bytes;
  return sum;
}

SceneStore::~SceneStore() {
  for (StoredScene& stored : scenes) release(&stored);
}

Status store_scene(const std::string& name, const std::string& path, bool lights_rooms, std::uint64_t bytes_left,
                   SceneStore* store) {
  CHECK(store != nullptr);
  StoredScene stored;
  Status status = read_bytes(path, bytes_left, &stored);
  if (status.ok) status = open_stored(bytes_left, &stored);
  bool is_lit = false;
  if (status.ok && lights_rooms) status = store_lit(name, path, stored, bytes_left, store, &is_lit);
  return add_scene(is_lit ? name + " (for devices)" : name, status, &stored, store);
}

Status store_baked_scene(const std::string& name, const std::uint8_t* bytes, std::size_t byte_count,
                         std::uint64_t bytes_left, SceneStore* store) {
  CHECK(bytes != nullptr && store != nullptr);
  if (byte_count > bytes_left) return too_many_bytes(bytes_left);
  StoredScene stored;
  std::uint8_t* copy = take_aligned(byte_count, &stored.baked_block);
  if (!copy) return failure("cannot get %zu bytes of memory", byte_count);
  std::memcpy(copy, bytes, byte_count);
  stored.bytes = copy, stored.byte_count = byte_count;
  return add_scene(name, open_stored(bytes_left, &stored), &stored, store);
}

Status open_scene_store(const SceneStoreOptions& options, SceneStore* store) {
  struct Source {
    std::string name, path;
  };
  std::vector<Source> sources;
  int builtin_count;
  const BuiltinScene* builtins = builtin_list(&builtin_count);
  for (int i = 0; i < builtin_count; ++i) sources.push_back({builtins[i].name, builtins[i].name});
  if (!options.folder.empty()) {
    std::vector<std::string> names;
    platform::FileError error;
    auto add = [](void* context, const char* name) {
      static_cast<std::vector<std::string>*>(context)->push_back(name);
    };
    if (!platform::list_folder(options.folder.c_str(), add, &names, &error))
      return failure("%.200s %s", options.folder.c_str(), error.text);
    std::sort(names.begin(), names.end());
    for (const std::string& name : names)
      if (is_scene_file(name)) sources.push_back({name, options.folder + "/" + name});
  }

  std::uint64_t bytes_left = options.bytes_max;
  Progress progress = start_progress("reading scenes", sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    Status status = store_scene(sources[i].name, sources[i].path, options.lights_rooms, bytes_left, store);
    if (!status.ok) store->warnings.push_back(sources[i].name + " is skipped: " + status.message);
    CHECK_LE(stored_bytes(*store), options.bytes_max);
    bytes_left = options.bytes_max - stored_bytes(*store);
    show_progress(&progress, i + 1);
  }
  end_progress(&progress);
  return success();
}

const StoredScene* find_scene(const SceneStore& store, const ContentHash& hash) {
  for (const StoredScene& stored : store.scenes)
    if (stored.hash == hash) return &stored;
  return nullptr;
}

}  // namespace pocketray
