#include "platform/memory.h"

#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

namespace platform {
namespace {

// Returns the number after `name` in /proc/meminfo, in bytes; 0 if missing.
std::size_t read_entry(const char* text, const char* name) {
  const char* at = strstr(text, name);
  unsigned long long kilobytes = at ? strtoull(at + strlen(name), nullptr, 10) : 0;
  return kilobytes > SIZE_MAX / 1024 ? SIZE_MAX : static_cast<std::size_t>(kilobytes) * 1024;
}

}  // namespace

void wish_large_pages(void* block, std::size_t byte_count) {
  uintptr_t page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE)), begin = reinterpret_cast<uintptr_t>(block);
  uintptr_t first = (begin + page - 1) / page * page, end = (begin + byte_count) / page * page;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

std::size_t free_memory() {
  int file = open("/proc/meminfo", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  char text[4096];
  ssize_t count = read(file, text, sizeof text - 1);
  close(file);
  if (count <= 0) return 0;
  text[count] = 0;
  std::size_t bytes = read_entry(text, "MemAvailable:");
  // Linux before 3.14 has no estimate.
  if (bytes == 0) bytes = read_entry(text, "MemFree:") + read_entry(text, "\nCached:");
  std::size_t swap = read_entry(text, "SwapFree:");
  return bytes > SIZE_MAX - swap ? SIZE_MAX : bytes + swap;
}

}  // namespace platform
