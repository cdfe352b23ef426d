#include "support/hard_case.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace pocketray {
namespace {

struct Beside {
  std::string method, answer;
  std::uint64_t inputs = 0;
  Answers ordinary, ours;
};
struct HardCase {
  std::string name, bound;
  std::uint64_t inputs = 0, wrong = 0;
  std::vector<Beside> beside;
};
HardCase running;
std::atomic<std::int64_t> progress_due{0};  // milliseconds of the steady clock

const char* line_file() { return std::getenv("POCKETRAY_HARDCASES"); }

double requested_share() {
  const char* text = std::getenv("POCKETRAY_HARDCASES_SHARE");
  if (!text || !*text) return 1;
  char* end;
  const double share = std::strtod(text, &end);
  if (*end || !(share > 0 && share <= 1)) {
    std::fprintf(stderr, "POCKETRAY_HARDCASES_SHARE is '%s': it must lie in (0, 1]\n", text);
    std::exit(1);
  }
  return share;
}

// Writes the line of each hard case at its end.
struct GateListener : doctest::IReporter {
  explicit GateListener(const doctest::ContextOptions&) {}
  void test_case_start(const doctest::TestCaseData& test) override {
    running = HardCase();
    running.name = test.m_name;
    if (is_hard_case()) std::fprintf(stderr, "\r\033[K%s", test.m_name);
  }
  void test_case_end(const doctest::CurrentTestCaseStats& stats) override {
    if (!is_hard_case()) return;
    std::uint64_t failed = static_cast<std::uint64_t>(stats.numAssertsFailedCurrentTest);
    if (stats.failure_flags && failed == 0) failed = 1;
    if (running.inputs == 0) running.inputs = static_cast<std::uint64_t>(stats.numAssertsCurrentTest);
    if (running.bound.empty()) running.bound = "every assertion holds";
    std::uint64_t wrong = running.wrong > 0 ? running.wrong : failed;
    std::FILE* file = std::fopen(line_file(), "a");
    if (!file) std::perror(line_file()), std::abort();
    std::fprintf(file, "%s\t%llu\t%llu\t%s\t%.1f\t", running.name.c_str(),
                 static_cast<unsigned long long>(running.inputs), static_cast<unsigned long long>(wrong),
                 running.bound.c_str(), stats.seconds);
    for (const Beside& b : running.beside)
      std::fprintf(file, "%s%s|%s|%llu|%llu|%.9g|%llu|%.9g", &b == &running.beside[0] ? "" : ";", b.method.c_str(),
                   b.answer.c_str(), static_cast<unsigned long long>(b.inputs),
                   static_cast<unsigned long long>(b.ordinary.wrong), b.ordinary.seconds,
                   static_cast<unsigned long long>(b.ours.wrong), b.ours.seconds);
    std::fprintf(file, "\t%.4g\n", requested_share());
    std::fclose(file);
    std::fprintf(stderr, "\r\033[K");
  }
  static bool is_hard_case() {
    return line_file() &&
           (running.name.compare(0, 5, "hard_") == 0 || running.name.compare(0, 13, "differential_") == 0);
  }

  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
REGISTER_LISTENER("hard cases", 1, GateListener);

}  // namespace

bool whole_gate() { return line_file() && requested_share() == 1; }

int gate_share(int usual, int whole) {
  if (!line_file()) return effort(kSoftFloats ? (usual + 3) / 4 : usual);
  return effort(std::max(std::min(usual, whole), static_cast<int>(whole * requested_share())));
}

void count_hard(std::uint64_t inputs, std::uint64_t wrong, const char* bound) {
  running.inputs += inputs, running.wrong += wrong, running.bound = bound;
}

void count_assertions(const char* bound) { running.bound = bound; }

void count_beside(const char* method, const char* answer, std::uint64_t inputs, const Answers& ordinary,
                  const Answers& ours) {
  auto known = std::find_if(running.beside.begin(), running.beside.end(),
                            [&](const Beside& b) { return b.method == method && b.answer == answer; });
  if (known == running.beside.end()) known = running.beside.insert(known, {method, answer, 0, {}, {}});
  known->inputs += inputs;
  known->ordinary.wrong += ordinary.wrong, known->ordinary.seconds += ordinary.seconds;
  known->ours.wrong += ours.wrong, known->ours.seconds += ours.seconds;
}

void show_gate_progress(std::uint64_t done, std::uint64_t count) {
  if (!line_file()) return;
  std::int64_t now = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::milliseconds(1);
  std::int64_t due = progress_due;
  if (now < due || !progress_due.compare_exchange_strong(due, now + 500)) return;
  std::fprintf(stderr, "\r\033[K%s: %llu of %llu", running.name.c_str(), static_cast<unsigned long long>(done),
               static_cast<unsigned long long>(count));
}

}  // namespace pocketray
