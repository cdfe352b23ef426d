#include "platform/memory.h"

#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

namespace platform {

void wish_large_pages(void* block, std::size_t byte_count) {
  uintptr_t page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE)), begin = reinterpret_cast<uintptr_t>(block);
  uintptr_t first = (begin + page - 1) / page * page, end = (begin + byte_count) / page * page;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

}  // namespace platform
