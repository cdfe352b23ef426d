// The heap of the test build: aborts on any allocation under the seal. Linked into pocketray_sealed, which is otherwise
// the unchanged program. A dynamic program finds these functions before the C library's; a static one is linked with
// --wrap, which redirects every call here.
#include <unistd.h>
#include <cstddef>

#include "base/seal.h"

#ifdef POCKETRAY_WRAP_HEAP
#define HEAP(name) __wrap_##name
#define REAL(name) __real_##name
#else
#define HEAP(name) name
#define REAL(name) __libc_##name
#endif

extern "C" {
void* REAL(malloc)(std::size_t);
void* REAL(calloc)(std::size_t, std::size_t);
void* REAL(realloc)(void*, std::size_t);

static void check_seal() {
  if (!pocketray::memory_sealed.load(std::memory_order_relaxed)) return;
  static const char text[] = "an allocation under the seal\n";
  if (write(STDERR_FILENO, text, sizeof text - 1) < 0) _exit(134);
  __builtin_trap();
}

void* HEAP(malloc)(std::size_t bytes) {
  check_seal();
  return REAL(malloc)(bytes);
}
void* HEAP(calloc)(std::size_t count, std::size_t bytes) {
  check_seal();
  return REAL(calloc)(count, bytes);
}
void* HEAP(realloc)(void* old, std::size_t bytes) {
  check_seal();
  return REAL(realloc)(old, bytes);
}
}
