#include "desktop/sweep/bake_rig.h"

#include <algorithm>
#include <thread>

#include "base/check.h"
#include "scene/baked.h"
#include "scene/builtin/builtin.h"
#include "session/compress.h"
#include "session/heap_scene.h"
#include "session/radiosity.h"

namespace pocketray {
namespace {

ModelOptions model_options(const BakeChoices& choices, const Renderer& renderer, const SceneSource& source) {
  ModelOptions model;
  model.texture_side_max = choices.texture_side_max;
  model.mip_maps = choices.has_mip_maps;
  const Look& look = renderer.view.look;
  model.studio = look.environment == EnvironmentChoice::as_scene && !look.has_background;
  model.animations = renderer.view.animation != kNone;
  model.reading = source.reading;
  return model;
}

std::uint32_t longest_side(const Scene& scene) {
  std::uint32_t longest = 0;
  for (const Texture& texture : scene.textures)
    longest = std::max(longest, std::max<std::uint32_t>(texture.width, texture.height));
  return longest;
}

struct HeapAccel {
  void* block = nullptr;
  ~HeapAccel() { give_block_back(block); }
};

}  // namespace

Status load_as_baked(const BakeChoices& choices, const std::string& accel, const std::string& name, Renderer* renderer,
                     SceneSource* source, SceneStorage* storage, double* seconds) {
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr && seconds != nullptr);
  const std::uint64_t start = clock_ns();
  const RadiosityWork work = {std::thread::hardware_concurrency(), choices.patch_count};
  if (is_baked_name(name)) {  // only radiosity can be added
    CHECK_GT(choices.patch_count, 0u);
    RETURN_IF_ERROR(load_scene(name, renderer, source, storage));
    RETURN_IF_ERROR(solve_into(work, name, renderer, source, storage));
    *seconds = static_cast<double>(clock_ns() - start) * 1e-9;
    return success();
  }
  HeapScene heap;
  RETURN_IF_ERROR(read_heap_scene(name, model_options(choices, *renderer, *source), &heap));
  Scene& scene = heap.scene;
  SolvedRadiosity solved;
  if (choices.patch_count > 0) RETURN_IF_ERROR(solve_scene(name, work, &scene, &solved));
  CompressedTextures compressed;
  if (choices.is_compressed) compress_textures(&scene, &compressed);
  HeapAccel built;
  const AccelInfo* info = find_accel(accel);
  built.block = build_heap_accel(info && info->magic ? *info : kBvhAccel, scene, &scene.accel);
  if (!built.block) return failure("not enough memory to build the accelerator of %.200s", name.c_str());
  const std::size_t size = baked_size(scene);
  auto* bytes = static_cast<std::uint8_t*>(arena_try_allocate(&renderer->memory.scene, size));
  if (!bytes) return scene_too_large(name, size, renderer->settings.memory_bytes, source);
  baked_write(scene, bytes);
  *seconds = static_cast<double>(clock_ns() - start) * 1e-9;
  *storage = SceneStorage();
  source->baked = bytes, source->baked_bytes = size;
  storage->arena_bytes = renderer->memory.scene.used;
  const Status status = baked_open(bytes, size, &renderer->scene);
  return status.ok ? status : failure("%s: %.400s", name.c_str(), status.message);
}

std::size_t stored_bytes_of(const Renderer& renderer) {
  Scene scene = renderer.scene;
  if (renderer.accel.info->magic) scene.accel = renderer.accel.built.data;
  return baked_size(scene);
}

Status find_bakeable(const std::string& name, const OpenScene& opened, bool has_own_look, BakeableScene* bakeable) {
  CHECK(bakeable != nullptr);
  *bakeable = BakeableScene();
  const Scene& scene = opened.renderer.scene;
  if (is_baked_name(name)) return success();  // `bake` reads models and built-in scenes
  bakeable->texture_side = longest_side(scene);
  bakeable->is_lit = has_own_look && (scene.radiosity_triangles.empty() || opened.source.lit_unasked) &&
                     can_solve_radiosity(scene);
  bakeable->is_model = find_builtin(name.c_str()) == nullptr;
  if (!bakeable->is_model) return success();
  BakeChoices choices;
  choices.texture_side_max = kTextureSideSwept;
  HeapScene heap;
  RETURN_IF_ERROR(read_heap_scene(name, model_options(choices, opened.renderer, opened.source), &heap));
  bakeable->texture_side = longest_side(heap.scene);
  return success();
}

}  // namespace pocketray
