// The memory block and the system's memory.
#include <doctest/doctest.h>

#include <cstring>

#include "session/open_scene.h"

using namespace pocketray;

constexpr std::size_t kMebibyte = 1 << 20;

// Goal: by default the block leaves room for the rest of the system; a larger one is refused with one that fits.
// Method: a handheld of 64 MB, and systems that tell nothing or have hardly anything.
TEST_CASE("memory_default_leaves_the_system_an_eighth") {
  CHECK(memory_to_take(50 * kMebibyte + 12345) == 43 * kMebibyte);
  CHECK(memory_to_take(10 * kMebibyte + 12345) == 6 * kMebibyte);
  CHECK(memory_to_take(0) == kMemoryBytesMax);
  CHECK(memory_to_take(1000) == kMemoryBytesMin);
}
TEST_CASE("memory_beyond_the_systems_is_refused_with_what_fits") {
  CHECK(check_memory(50 * kMebibyte, 50 * kMebibyte).ok);
  CHECK(check_memory(50 * kMebibyte, 0).ok);
  Status status = check_memory(64 * kMebibyte, 50 * kMebibyte);
  REQUIRE_FALSE(status.ok);
  CHECK(std::strstr(status.message, "64.0 MiB but the system has only 50.0 MiB free") != nullptr);
  CHECK(std::strstr(status.message, "try --memory 44032K") != nullptr);
}
