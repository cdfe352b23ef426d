// Reading the output of callgrind.
#include "desktop/accuracy/callgrind.h"

#include <doctest/doctest.h>

using namespace pocketray;

namespace {

// As valgrind 3.19 writes it.
const std::string kDump =
    "# callgrind format\nversion: 1\ncreator: callgrind-3.19.0\npid: 9366\ncmd:  ./pocketray accuracy totals: 7\npart: "
    "2\n"
    "\n\ndesc: I1 cache: \ndesc: Timerange: Basic block 52845570 - 57548533\n"
    "desc: Trigger: --dump-before=pocketray::begin_counted_frame()\n\npositions: line\nevents: Ir\n"
    "summary: 10000000050\n\n\nob=(1) pocketray\nfl=(2) trace.cpp\nfn=(3) trace\n16 40\ncalls=1 0 \n0 10000000000\n\n"
    "totals: 10000000040\n";

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kDump;
  std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

// Goal: the sum of a dump is read, more than 32 bits of it. Method: a dump of a few lines, with different sums and a
// command line that looks like one.
TEST_CASE("callgrind_dump_has_a_total") {
  std::uint64_t instructions = 0;
  REQUIRE(read_callgrind_dump(kDump, &instructions));
  CHECK(instructions == 10000000040u);
}

// Goal: anything but a complete dump before a function is refused. Method: every shorter text; the dump that callgrind
// makes at program exit; sums that are not numbers.
TEST_CASE("callgrind_dump_that_is_none_is_refused") {
  std::uint64_t instructions = 5;
  for (std::size_t length = 0; length < kDump.size(); ++length)
    CHECK_MESSAGE(!read_callgrind_dump(kDump.substr(0, length), &instructions), length);
  CHECK(!read_callgrind_dump(replaced("--dump-before=pocketray::begin_counted_frame()", "Program termination"),
                             &instructions));
  for (const char* sum : {"totals: x", "totals: -4", "totals:", "totals: "})
    CHECK_MESSAGE(!read_callgrind_dump(replaced("totals: 10000000040", sum), &instructions), sum);
  CHECK(instructions == 5);
}
