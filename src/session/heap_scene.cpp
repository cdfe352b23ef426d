#include "session/heap_scene.h"

#include <algorithm>

#include "base/check.h"
#include "scene/builtin/builtin.h"

namespace pocketray {

Status read_heap_scene(const std::string& name, const ModelOptions& options, HeapScene* result) {
  CHECK(result != nullptr);
  if (const BuiltinScene* builtin = find_builtin(name.c_str())) {
    result->memory.resize(builtin->need() + kArenaAlignment);
    Arena arena = make_arena("scene", result->memory.data(), result->memory.size());
    builtin->build(&arena, &result->scene);
    return success();
  }
  if (!is_local_scene(name)) return unknown_scene(name);
#ifdef POCKETRAY_HAVE_IMPORT
  ImportOptions import_options;
  import_options.texture_side_max = options.texture_side_max;
  import_options.mip_maps = options.mip_maps;
  import_options.tells_halved = options.tells_halved;
  apply(options.reading, &import_options);
  import_options.animations = options.animations;
  RETURN_IF_ERROR(import_model(name, import_options, &result->imported, options.studio));
  result->scene = result->imported.scene;
  result->warning = result->imported.warning;
  result->files = result->imported.files;
  result->has_fill = result->imported.has_fill;
  return success();
#else
  (void)options;
  return failure("%s cannot be read: this build has no importers; bake it on a desktop", name.c_str());
#endif
}

void* build_heap_accel(const AccelInfo& info, const Scene& scene, Array<const std::uint8_t>* result) {
  CHECK(result != nullptr);
  std::uint32_t count = scene.triangles.count;
  std::size_t keep_bytes = arena_need(info.need(count)) + kArenaAlignment,
              scratch_bytes = arena_need(info.scratch_need(count)) + kArenaAlignment;
  void* building = take_block(keep_bytes + scratch_bytes);
  if (!building) return nullptr;
  Arena keep = make_arena("accelerator", building, keep_bytes),
        scratch = make_arena("scratch", static_cast<std::uint8_t*>(building) + keep_bytes, scratch_bytes);
  Accel accel;
  accel.positions = scene.positions;
  accel.triangles = scene.triangles;
  info.build(&accel, &keep, &scratch);
  CHECK_LE(accel.data.bytes(), info.need(count));
  void* block = take_block(arena_need(accel.data.count) + kArenaAlignment);
  if (block) {
    Arena kept = make_arena("accelerator", block, arena_need(accel.data.count) + kArenaAlignment);
    Array<std::uint8_t> data = arena_array<std::uint8_t>(&kept, accel.data.count);
    std::copy(accel.data.begin(), accel.data.end(), data.begin());
    *result = data;
  }
  give_block_back(building);
  return block;
}

}  // namespace pocketray
