// References by a team: the same file as by one program, bit for bit, whatever happens on the way.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <atomic>
#include <cstdio>

#include "desktop/sweep/reference_team.h"
#include "session/interrupt.h"
#include "support/fake_team.h"

using namespace pocketray;

namespace {

AccuracyOptions small_cube(const char* size = "16x12") {
  AccuracyOptions o;
  o.common.scene = "cube";
  o.common.size = size;
  o.common.threads = 1;
  o.common.memory = "16M";
  return o;
}

// A file that is removed at the end.
struct TemporaryFile {
  char path[40] = "/tmp/pocketray_team_XXXXXX";
  TemporaryFile() { REQUIRE(mkstemp(path) >= 0); }
  ~TemporaryFile() { std::remove(path); }
};

Status open_small(const AccuracyOptions& options, std::unique_ptr<Rig>* rig) {
  RETURN_IF_ERROR(open_rig(options, kCornellSphereColumns, rig));
  return prepare_for_reference(options.seconds, rig->get());
}

struct Result {
  Status status;
  bool whole = false;
  std::uint32_t opening = 0;  // helpers that had yet to open their scene when the leader had the reference
  Accumulation sum;
};

// Takes samples with so many ranks. odd_options: what the last rank has opened instead.
Result take(ReferenceGoal goal, std::uint32_t size, const Accumulation* there = nullptr,
            const AccuracyOptions* odd_options = nullptr) {
  Result result;
  TemporaryFile file;
  goal.path = file.path;
  FakeTeam fake(size);
  const AccuracyOptions usual = small_cube();
  std::atomic<std::uint32_t> begun{0};
  fake.run([&](const Team& team) {
    const AccuracyOptions& options = odd_options && team.rank + 1 == team.size ? *odd_options : usual;
    std::unique_ptr<Rig> rig;
    ReferenceHelper helper(team, options, [&](Rig** found) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100 * team.rank));
      ++begun;
      return *found = rig.get(), success();
    });
    auto lead = [&] {
      ReferenceGoal own = goal;
      own.team = team;
      result.status = open_small(options, &rig);
      if (!result.status.ok) return 1;
      result.sum = there ? *there : empty_accumulation(reference_key(*rig, options, goal.transport), 16, 12);
      result.status = run_reference(own, rig.get(), &result.sum, &result.whole);
      result.opening = team.size - 1 - begun;
      return 0;
    };
    return run_in_team(
        team, lead, [&] { return open_small(options, &rig); },
        [&](const TeamMessage& message) { return helper.work(message); });
  });
  return result;
}

std::vector<std::uint8_t> bytes_of(const Result& result) {
  REQUIRE_MESSAGE(result.status.ok, result.status.message);
  return encode_accumulation(result.sum);
}

}  // namespace

// Goal: any number of ranks gives the file of one program, to a number of samples, of a part, and to a measured error,
// which ends at the same number of samples.
TEST_CASE("reference_team_equals_one_program") {
  ReferenceGoal of_samples, of_part, until;
  of_samples.samples = 90;
  of_part.samples = 64, of_part.part = 2, of_part.part_count = 3;
  until.until = 0.1;
  for (const ReferenceGoal& goal : {of_samples, of_part, until}) {
    CAPTURE(goal.until);
    Result alone = take(goal, 1);
    std::vector<std::uint8_t> expected = bytes_of(alone);
    CHECK((goal.until == 0 || samples_of(alone.sum) > 8));
    for (std::uint32_t size : {2u, 3u}) {
      CAPTURE(size);
      Result shared = take(goal, size);
      CHECK(shared.whole);
      CHECK(shared.opening == 0);  // nothing disturbs what the leader measures next
      CHECK(bytes_of(shared) == expected);
    }
  }
}

// Goal: an interrupted team keeps its samples, and another number of ranks goes on from them to the same file.
TEST_CASE("reference_team_goes_on_after_an_interrupt_with_other_ranks") {
  ReferenceGoal goal;
  goal.samples = 80;
  std::vector<std::uint8_t> expected = bytes_of(take(goal, 1));
  std::uint32_t rows = 0;
  goal.row_done = [&](std::uint32_t) { interrupted = ++rows >= 40; };
  Result begun = take(goal, 3);
  interrupted = false;
  REQUIRE(begun.status.ok);
  CHECK(!begun.whole);
  std::uint64_t there = 0;
  for (const SampleSet& row : begun.sum.rows) there += sample_count(row);
  CHECK(there > 0);
  CHECK(there < 40 * 12);
  goal.row_done = nullptr;
  CHECK(bytes_of(take(goal, 2, &begun.sum)) == expected);
  CHECK(bytes_of(take(goal, 1, &begun.sum)) == expected);
}

// Goal: a rank with another scene, or that cannot open its own, ends the team with an error that names it.
TEST_CASE("reference_team_ends_if_a_rank_differs") {
  ReferenceGoal goal;
  goal.samples = 32;
  AccuracyOptions other = small_cube("16x16"), missing = small_cube();
  missing.common.scene = "no_such_scene";
  Result differs = take(goal, 3, nullptr, &other);
  CHECK(std::string(differs.status.message).find("rank 2: its scene or program differs from rank 0's") == 0);
  Result fails = take(goal, 2, nullptr, &missing);
  CHECK(std::string(fails.status.message).find("rank 1: no_such_scene") == 0);
}
