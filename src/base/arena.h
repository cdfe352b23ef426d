// A named part of the one memory block: allocates by advancing a pointer, releases to a mark, never calls the system.
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "base/array.h"

namespace pocketray {

constexpr std::size_t kArenaAlignment = 64;  // a cache line; every allocation starts on one

// Planned sizes may exceed the address space of a 32-bit CPU. Sums and products saturate at SIZE_MAX, which no block
// holds, instead of wrapping around to a size that seems to fit.
constexpr std::size_t size_sum(std::size_t a, std::size_t b) { return a > SIZE_MAX - b ? SIZE_MAX : a + b; }
constexpr std::size_t to_size(std::uint64_t bytes) {
  return bytes > SIZE_MAX ? SIZE_MAX : static_cast<std::size_t>(bytes);
}

// Bytes that an allocation of `bytes` takes from an arena.
constexpr std::size_t arena_need(std::uint64_t bytes) {
  return bytes > SIZE_MAX - kArenaAlignment
             ? SIZE_MAX
             : (static_cast<std::size_t>(bytes) + kArenaAlignment - 1) / kArenaAlignment * kArenaAlignment;
}
template <class T>
constexpr std::size_t arena_need(std::size_t count) {
  return arena_need(std::uint64_t(count) * sizeof(T));
}

struct Arena {
  const char* name = "";
  std::uint8_t* base = nullptr;
  std::size_t capacity = 0;  // bytes
  std::size_t used = 0;
  std::size_t used_max = 0;
};

// Takes `capacity` bytes from the front of `block`. The base is aligned upward, so up to 63 of them may be lost.
Arena make_arena(const char* name, void* block, std::size_t capacity);

// Bytes still free.
std::size_t arena_free(const Arena& arena);

// Aborts when the arena is full: sizes are planned, so that is a programmer error. Memory is not cleared. Sizes are 64
// bits wide on every CPU, so that a count from a file or a server is checked before it is narrowed to size_t.
void* arena_allocate(Arena* arena, std::uint64_t bytes);
// arena_allocate() that returns null when the arena is full, for callers that report a Status.
void* arena_try_allocate(Arena* arena, std::uint64_t bytes);

inline std::size_t arena_mark(const Arena& arena) { return arena.used; }
void arena_release(Arena* arena, std::size_t mark);

template <class T>
Array<T> arena_array(Arena* arena, std::size_t count) {
  static_assert(std::is_trivially_destructible<T>::value, "arenas run no destructors");
  return {static_cast<T*>(arena_allocate(arena, std::uint64_t(count) * sizeof(T))), static_cast<std::uint32_t>(count)};
}
template <class T>
Array<T> arena_array_zeroed(Arena* arena, std::size_t count) {
  Array<T> array = arena_array<T>(arena, count);
  __builtin_memset(static_cast<void*>(array.data), 0, array.bytes());
  return array;
}

}  // namespace pocketray
