// The heap of the test build: aborts on any allocation while the seal is on. Linked into pocketray_sealed, which is the
// program otherwise unchanged.
#include <cstddef>
#include <unistd.h>

#include "base/seal.h"

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {
void check_seal() {
  if (!pocketray::memory_sealed.load(std::memory_order_relaxed)) return;
  static const char text[] = "an allocation under the seal\n";
  if (write(STDERR_FILENO, text, sizeof text - 1) < 0) _exit(134);
  __builtin_trap();
}
}  // namespace

extern "C" {
void* malloc(std::size_t bytes) {
  check_seal();
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
  check_seal();
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) {
  check_seal();
  return __libc_realloc(old, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  check_seal();
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t bytes) {
  check_seal();
  *result = __libc_memalign(alignment, bytes);
  return *result ? 0 : 12;
}
}
