#include "session/scene_identity.h"

#include "base/check.h"
#include "scene/baked.h"

namespace pocketray {

Status identify_scene(const SceneSource& source, Renderer* renderer, ContentHash* hash) {
  CHECK(renderer != nullptr && hash != nullptr);
  CHECK((source.baked != nullptr) == (source.baked_bytes > 0));
  if (source.baked) {
    *hash = source.has_all_levels ? content_hash(source.baked, source.baked_bytes) : source.whole;
    return success();
  }
  std::size_t byte_count = baked_size(renderer->scene), mark = arena_mark(renderer->memory.scene);
  auto* bytes = static_cast<std::uint8_t*>(arena_try_allocate(&renderer->memory.scene, byte_count));
  if (!bytes)
    return failure(
        "identifying the scene to a server takes %.1f MiB but --memory leaves %.1f MiB: use --memory %zuM",
        static_cast<double>(byte_count) / (1 << 20),
        static_cast<double>(arena_free(renderer->memory.scene)) / (1 << 20),
        (renderer->settings.memory_bytes - arena_free(renderer->memory.scene) + byte_count + (1 << 20) - 1) >> 20);
  baked_write(renderer->scene, bytes);
  *hash = content_hash(bytes, byte_count);
  arena_release(&renderer->memory.scene, mark);
  return success();
}

}  // namespace pocketray
