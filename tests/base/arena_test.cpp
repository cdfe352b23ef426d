#include "base/arena.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include <string>
#include <vector>

using namespace pocketray;

namespace {

// Runs `act` in a child process and returns its stderr; *aborted: it ended by SIGABRT.
template <class Act>
std::string stderr_of(Act act, bool* aborted) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    signal(SIGABRT, SIG_DFL);
    dup2(ends[1], STDERR_FILENO);
    act();
    _exit(0);
  }
  close(ends[1]);
  std::string text;
  char buffer[256];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  *aborted = WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
  return text;
}

}  // namespace

// Goal: need() is the size of an allocation, rounded up to cache lines.
TEST_CASE("arena_need_rounds_up_to_cache_lines") {
  CHECK(arena_need(0) == 0);
  CHECK(arena_need(1) == 64);
  CHECK(arena_need(64) == 64);
  CHECK(arena_need(65) == 128);
  CHECK(arena_need<double>(9) == 128);
}

// Goal: every allocation is aligned, whatever block it comes from, and none overlap. Method: all 64 misalignments.
TEST_CASE("arena_allocations_are_aligned_and_disjoint") {
  std::vector<std::uint8_t> block(2048);
  for (std::size_t skew = 0; skew < 64; ++skew) {
    Arena arena = make_arena("test", block.data() + skew, 1024);
    CHECK(arena.base >= block.data() + skew);
    CHECK(arena.base + arena.capacity == block.data() + skew + 1024);
    std::uint8_t* a = static_cast<std::uint8_t*>(arena_allocate(&arena, 1));
    std::uint8_t* b = static_cast<std::uint8_t*>(arena_allocate(&arena, 65));
    Array<double> c = arena_array<double>(&arena, 3);
    CHECK(reinterpret_cast<std::uintptr_t>(a) % 64 == 0);
    CHECK(b == a + 64);
    CHECK(reinterpret_cast<std::uint8_t*>(c.data) == b + 128);
    CHECK(c.count == 3);
    CHECK(arena.used == 64 + 128 + 64);
  }
}

// Goal: release returns to a mark, the peak is remembered.
TEST_CASE("arena_release_returns_to_the_mark_and_keeps_the_peak") {
  alignas(64) std::uint8_t block[512];
  Arena arena = make_arena("test", block, sizeof block);
  arena_allocate(&arena, 64);
  std::size_t mark = arena_mark(arena);
  void* first = arena_allocate(&arena, 256);
  arena_release(&arena, mark);
  CHECK(arena.used == 64);
  CHECK(arena.used_max == 320);
  CHECK(arena_free(arena) == 448);
  CHECK(arena_allocate(&arena, 1) == first);
}

// Goal: a full arena returns null from arena_try_allocate(), even for sizes that would wrap when rounded.
TEST_CASE("arena_try_allocate_gives_null_when_full") {
  alignas(64) std::uint8_t block[128];
  Arena arena = make_arena("test", block, sizeof block);
  CHECK(arena_try_allocate(&arena, 129) == nullptr);
  CHECK(arena_try_allocate(&arena, SIZE_MAX) == nullptr);
  CHECK(arena_try_allocate(&arena, SIZE_MAX - 62) == nullptr);
  CHECK(arena.used == 0);
  CHECK(arena_try_allocate(&arena, 128) == block);
  CHECK(arena_try_allocate(&arena, 1) == nullptr);
  CHECK(arena_try_allocate(&arena, 0) != nullptr);
}

TEST_CASE("arena_array_zeroed_is_zero") {
  alignas(64) std::uint8_t block[128];
  for (std::uint8_t& byte : block) byte = 0xAB;
  Arena arena = make_arena("test", block, sizeof block);
  for (std::uint32_t x : arena_array_zeroed<std::uint32_t>(&arena, 32)) CHECK(x == 0);
}

// Goal: misuse aborts and prints both operands. Method: in a child process.
TEST_CASE("check_prints_both_operands_and_aborts") {
  alignas(64) static std::uint8_t block[128];
  bool aborted = false;
  std::string text = stderr_of(
      [] {
        Arena arena = make_arena("test", block, sizeof block);
        arena_allocate(&arena, 300);
      },
      &aborted);
  CHECK(aborted);
  CHECK(text.find("320 against 128") != std::string::npos);
  text = stderr_of(
      [] {
        Arena arena = make_arena("test", block, sizeof block);
        arena_release(&arena, 64);
      },
      &aborted);
  CHECK(aborted);
  CHECK(text.find("64 against 0") != std::string::npos);
}

// Goal: sizes beyond any CPU's address space saturate instead of wrapping around to zero, and never fit. Method: the
// limits of 32 and 64 bits.
TEST_CASE("arena_sizes_stop_at_the_largest") {
  CHECK(size_sum(SIZE_MAX, 1) == SIZE_MAX);
  CHECK(size_sum(SIZE_MAX - 5, 5) == SIZE_MAX);
  CHECK(size_sum(SIZE_MAX - 5, 6) == SIZE_MAX);
  CHECK(size_sum(SIZE_MAX / 2 + 1, SIZE_MAX / 2 + 1) == SIZE_MAX);
  CHECK(size_sum(2, 3) == 5);
  CHECK(arena_need(std::uint64_t(0)) == 0);
  CHECK(arena_need(1) == kArenaAlignment);
  CHECK(arena_need(~std::uint64_t(0)) == SIZE_MAX);
  CHECK(arena_need<std::uint64_t>(SIZE_MAX) >= SIZE_MAX - kArenaAlignment);
  CHECK(to_size(~std::uint64_t(0)) == SIZE_MAX);
  alignas(64) std::uint8_t block[1024];
  Arena arena = make_arena("test", block, sizeof block);
  for (std::uint64_t bytes : {std::uint64_t(1025), std::uint64_t(0xFFFFFFFF), std::uint64_t(0x1'0000'0000),
                              std::uint64_t(0x1'0000'0040), ~std::uint64_t(0), ~std::uint64_t(0) - 62})
    CHECK(arena_try_allocate(&arena, bytes) == nullptr);
  CHECK(arena_try_allocate(&arena, 1024) == arena.base);
}
