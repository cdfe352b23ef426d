// A loop whose items may run on several threads, for code that does not know where the threads come from.
#pragma once
#include <cstdint>

namespace pocketray {

struct ParallelLoop {
  // Calls take(context, i) once for each i below item_count, in any order, and returns when all are done. Null: the
  // caller's thread takes them in order.
  void (*run)(void* threads, std::uint32_t item_count, void (*take)(void* context, std::uint32_t item),
              void* context) = nullptr;
  void* threads = nullptr;
};

// Calls body(i) for each i below item_count.
template <class Body>
void run_loop(const ParallelLoop& loop, std::uint32_t item_count, Body& body) {
  if (loop.run == nullptr || item_count < 2) {
    for (std::uint32_t i = 0; i < item_count; ++i) body(i);
    return;
  }
  loop.run(
      loop.threads, item_count, [](void* context, std::uint32_t item) { (*static_cast<Body*>(context))(item); }, &body);
}

}  // namespace pocketray
