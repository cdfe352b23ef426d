// Counted instructions.
#include "platform/instructions.h"

#include <doctest/doctest.h>

#include <thread>

using namespace platform;

// Goal: if instructions are counted, twice the work is about twice as many, including a thread's; otherwise the count
// is 0. Method: a loop that the compiler keeps.
TEST_CASE("instructions_count_work_or_say_that_they_cannot") {
  bool counts = start_instruction_count();
  CHECK(start_instruction_count() == counts);
  auto work = [](int rounds) {
    volatile int value = 0;
    for (int i = 0; i < rounds; ++i) value = value + 1;
  };
  auto cost = [&](int rounds) {
    std::uint64_t before = instruction_count();
    std::thread(work, rounds).join();
    work(rounds);
    return instruction_count() - before;
  };
  std::uint64_t once = cost(1000000), twice = cost(2000000);
  if (!counts) {
    MESSAGE("skipped: no instructions are counted here");
    CHECK(once == 0);
    return;
  }
  CHECK(once > 2000000);
  CHECK(twice > once * 9 / 5);
  CHECK(twice < once * 11 / 5);
}
