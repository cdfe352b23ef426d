// The hard cases (rows of HARDCASES.md) as one gate. A test named hard_NN_… or differential_… counts its inputs and the
// wrong results. With POCKETRAY_HARDCASES=FILE in the environment, which `make hardcases` sets, the gate runs with
// progress on stderr: all of it, or the share POCKETRAY_HARDCASES_SHARE, in (0, 1]. Each such test appends a line to
// FILE:
//   case TAB inputs TAB wrong TAB bound TAB seconds TAB ordinary methods TAB share
// in which an ordinary method is "method|answer|inputs|wrong|seconds|our wrong|our seconds", with ; between methods.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <ctime>
#include <thread>
#include <vector>

#include "base/rng.h"
#include "support/effort.h"

namespace pocketray {

// Returns whether all of the gate is requested.
bool whole_gate();

// How many inputs a test tries: `usual` in the suite, the requested share of `whole` in the gate but not fewer than
// usual, fewer of either under emulation.
int gate_share(int usual, int whole);

// Counts inputs of the running test and wrong answers among them; calls accumulate. `bound` describes a correct answer;
// the last one is kept.
void count_hard(std::uint64_t inputs, std::uint64_t wrong, const char* bound);
// For a test that asserts each of its inputs: its assertions are counted.
void count_assertions(const char* bound);

// Answers to some inputs by one method: how many were wrong, and the CPU time that all took.
struct Answers {
  std::uint64_t wrong = 0;
  double seconds = 0;
};
// Counts inputs of the running test that an ordinary method answered beside ours; calls for one method accumulate.
// `answer` describes a single answer: "ray against 320 triangles".
void count_beside(const char* method, const char* answer, std::uint64_t inputs, const Answers& ordinary,
                  const Answers& ours);

// Answers all inputs by find(input), timed, then judges with is_wrong(input, answer).
template <class Input, class Find, class IsWrong>
Answers time_answers(const std::vector<Input>& inputs, Find find, IsWrong is_wrong) {
  std::vector<decltype(find(inputs[0]))> answers(inputs.size());
  Answers result;
  const std::clock_t begin = std::clock();  // of the process: tests that call this have one thread
  for (std::size_t i = 0; i < inputs.size(); ++i) answers[i] = find(inputs[i]);
  result.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  for (std::size_t i = 0; i < inputs.size(); ++i) result.wrong += is_wrong(inputs[i], answers[i]) ? 1 : 0;
  return result;
}

// Reports the progress of a test of the full gate on stderr, at most twice a second. Thread-safe.
void show_gate_progress(std::uint64_t done, std::uint64_t count);

// Adds up check(rng, count) → wrong answers over blocks of `count` in total, on all threads of the machine. Each block
// has its own stream of random numbers, so the sum does not depend on the threads.
template <class Check>
std::uint64_t count_wrong(std::uint64_t count, std::uint64_t seed, Check check) {
  constexpr std::uint64_t kBlock = 1 << 14;
  std::atomic<std::uint64_t> next{0}, wrong{0};
  auto take_blocks = [&] {
    for (std::uint64_t begin; (begin = kBlock * next.fetch_add(1)) < count;) {
      Rng rng = make_rng(seed, begin / kBlock);
      wrong += check(&rng, static_cast<int>(std::min(kBlock, count - begin)));
      show_gate_progress(begin, count);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) threads.emplace_back(take_blocks);
  take_blocks();
  for (std::thread& thread : threads) thread.join();
  return wrong;
}

}  // namespace pocketray
