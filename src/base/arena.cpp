#include "base/arena.h"

#include "base/check.h"

namespace pocketray {

Arena make_arena(const char* name, void* block, std::size_t capacity) {
  CHECK(name != nullptr);
  CHECK(block != nullptr || capacity == 0);
  std::uintptr_t start = reinterpret_cast<std::uintptr_t>(block);
  std::size_t skip = (kArenaAlignment - start % kArenaAlignment) % kArenaAlignment;
  CHECK_LE(skip, capacity);
  Arena arena;
  arena.name = name;
  arena.base = static_cast<std::uint8_t*>(block) + skip;
  arena.capacity = capacity - skip;
  return arena;
}

std::size_t arena_free(const Arena& arena) { return arena.capacity - arena.used; }

void* arena_try_allocate(Arena* arena, std::uint64_t bytes) {
  CHECK_LE(arena->used, arena->capacity);
  CHECK_EQ(arena->used % kArenaAlignment, 0u);
  if (bytes > arena->capacity)
    return nullptr;  // compared before narrowing to size_t and before rounding up, which could wrap
  std::size_t need = arena_need(static_cast<std::size_t>(bytes));
  if (need > arena_free(*arena)) return nullptr;
  void* result = arena->base + arena->used;
  arena->used += need;
  if (arena->used > arena->used_max) arena->used_max = arena->used;
  return result;
}

void* arena_allocate(Arena* arena, std::uint64_t bytes) {
  void* result = arena_try_allocate(arena, bytes);
  if (!result) CHECK_LE(arena_need(bytes), arena_free(*arena));
  return result;
}

void arena_release(Arena* arena, std::size_t mark) {
  CHECK_LE(mark, arena->used);
  CHECK_EQ(mark % kArenaAlignment, 0u);
  arena->used = mark;
}

}  // namespace pocketray
