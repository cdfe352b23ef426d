#include "platform/memory.h"

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

using namespace platform;

namespace {

// The flags of an address's mapping in /proc/self/smaps; empty if it has none.
std::string flags_at(const void* address) {
  std::ifstream maps("/proc/self/smaps");
  std::string line;
  bool inside = false;
  while (std::getline(maps, line)) {
    unsigned long begin, end;
    if (std::sscanf(line.c_str(), "%lx-%lx ", &begin, &end) == 2) {
      unsigned long at = reinterpret_cast<unsigned long>(address);
      inside = begin <= at && at < end;
    } else if (inside && line.compare(0, 8, "VmFlags:") == 0) {
      return line.substr(8) + " ";
    }
  }
  return "";
}

}  // namespace

// Goal: the free memory is the system's own estimate. Method: its other record of the same, sysinfo(2), which counts no
// caches, below it, and all memory above.
TEST_CASE("memory_knows_what_is_free") {
#if defined(POCKETRAY_EMULATED) && UINTPTR_MAX <= 0xffffffff
  MESSAGE("skipped: the emulator's sysinfo counts modulo 4 GiB");
  return;
#endif
  struct sysinfo info;
  REQUIRE(sysinfo(&info) == 0);
  double all = (static_cast<double>(info.totalram) + static_cast<double>(info.totalswap)) * info.mem_unit;
  double unused = (static_cast<double>(info.freeram) + static_cast<double>(info.freeswap)) * info.mem_unit;
  double bytes = static_cast<double>(free_memory());
  double addressable = static_cast<double>(SIZE_MAX);  // of a 32-bit program on a large system
  CHECK(bytes > std::min(unused, addressable) / 4);    // the system keeps a reserve, and others take memory meanwhile
  CHECK(bytes <= all);
}

// Goal: large pages can be requested for a block, affecting all its whole pages and nothing else, without changing its
// content. Method: request them for the middle of a mapping, with ends within pages, and read Linux's record of it;
// systems without large pages record nothing.
TEST_CASE("memory_wishes_large_pages_for_a_block_and_nothing_besides") {
  const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE)), bytes = 64 * page;
  void* mapping = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  REQUIRE(mapping != MAP_FAILED);
  unsigned char* block = static_cast<unsigned char*>(mapping);
  std::memset(block, 7, bytes);
  wish_large_pages(block + 16 * page - 1, 32 * page + 2);
  wish_large_pages(block, 5);  // less than a page
  for (std::size_t i = 0; i < bytes; ++i) REQUIRE(block[i] == 7);
#ifdef POCKETRAY_EMULATED
  MESSAGE("skipped: the emulator tells nothing of large pages");
  munmap(mapping, bytes);
  return;
#endif
  if (access("/sys/kernel/mm/transparent_hugepage/enabled", F_OK) != 0 || flags_at(block).empty()) {
    MESSAGE("skipped: this system has no large pages");
  } else {
    for (std::size_t i = 0; i < 64; ++i) {
      bool wished = flags_at(block + i * page).find(" hg ") != std::string::npos;
      CHECK(wished == (i >= 16 && i < 48));
    }
  }
  munmap(mapping, bytes);
}
