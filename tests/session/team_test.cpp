// Teams of ranks: their end, their failures, what they run, and messages.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <algorithm>
#include <atomic>
#include <string>

#include "session/interrupt.h"
#include "session/report.h"
#include "support/fake_team.h"

using namespace pocketray;

namespace {

constexpr std::uint8_t kNumber = kTeamFirstOwn;

Status no_work(const TeamMessage&) { return success(); }

TeamMessage message_of(const TeamWriter& text) {
  TeamMessage message;
  message.bytes.resize(1 + text.bytes().size());
  std::copy(text.bytes().begin(), text.bytes().end(), message.bytes.begin() + 1);
  return message;
}

}  // namespace

// Goal: all ranks leave with the exit status of the leader, after all messages that it sent. Method: helpers add up
// numbers, of which the last are sent just before the leader ends.
TEST_CASE("team_leaves_with_the_leaders_exit_status_after_its_messages") {
  FakeTeam fake(4);
  std::atomic<std::uint64_t> sum{0};
  std::vector<int> exits = fake.run([&](const Team& team) {
    auto lead = [&] {
      for (std::uint32_t rank = 1; rank < team.size; ++rank)
        for (std::uint64_t value : {std::uint64_t(rank), std::uint64_t(100)})
          send_to(team, rank, kNumber, &value, sizeof value);
      return kExitInterrupted;
    };
    const int exit_status = run_in_team(team, lead, success, [&](const TeamMessage& m) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20 * team.rank));
      sum += TeamReader(m).number();
      return success();
    });
    if (leads(team)) CHECK(sum == 306);  // MPI would end with the leader
    return exit_status;
  });
  CHECK(exits == std::vector<int>(4, kExitInterrupted));
}

// Goal: a program alone just runs.
TEST_CASE("team_of_one_only_leads") {
  CHECK(run_in_team(
            Team(), [] { return kExitDone; }, [] { return failure("not called"); }, no_work) == kExitDone);
  TeamMessage message;
  bool there = true;
  CHECK(receive_from_helpers(Team(), 0, &message, &there).ok);
  CHECK(!there);
  CHECK(team_threads(Team(), 3) == 3);
  CHECK(team_threads(Team(), 0) == 0);
}

// Goal: a helper that fails, opening or working, tells the leader once, with its rank, and works no more; nobody hangs.
TEST_CASE("team_tells_the_leader_who_failed") {
  for (bool opening : {true, false}) {
    CAPTURE(opening);
    FakeTeam fake(3);
    Status told;
    std::atomic<int> worked{0};
    std::vector<int> exits = fake.run([&](const Team& team) {
      auto lead = [&] {
        for (int i = 0; i < 3; ++i) send_to(team, 2, kNumber, "x", 1);
        while (told.ok) {
          TeamMessage message;
          bool there;
          told = receive_from_helpers(team, 0.05, &message, &there);
          CHECK(!there);
        }
        return kExitInput;
      };
      auto fail = [&](bool now) { return now && team.rank == 2 ? failure("no such file") : success(); };
      return run_in_team(
          team, lead, [&] { return fail(opening); },
          [&](const TeamMessage&) {
            ++worked;
            return fail(!opening);
          });
    });
    CHECK(std::string(told.message) == "rank 2: no such file");
    CHECK(exits == std::vector<int>(3, kExitInput));
    CHECK(worked == (opening ? 0 : 1));
  }
}

// Goal: a helper that is interrupted interrupts the leader.
TEST_CASE("team_is_interrupted_by_any_rank") {
  FakeTeam fake(2);
  std::vector<int> exits = fake.run([&](const Team& team) {
    auto lead = [&] {
      interrupted = false;
      send_to(team, 1, kTeamFirstOwn, "x", 1);
      while (!interrupted) std::this_thread::yield();
      interrupted = false;  // as if it were another program's
      while (!interrupted) {
        TeamMessage message;
        bool there;
        CHECK(receive_from_helpers(team, 0.05, &message, &there).ok);
        CHECK(!there);
      }
      return kExitInterrupted;
    };
    return run_in_team(team, lead, success, [&](const TeamMessage&) {
      interrupted = true;
      while (interrupted) std::this_thread::yield();
      send_to(team, 0, kTeamInterrupted, nullptr, 0);
      return success();
    });
  });
  interrupted = false;
  CHECK(exits == std::vector<int>(2, kExitInterrupted));
}

// Goal: several ranks run only commands that share their work; others would overwrite each other's files.
TEST_CASE("team_refuses_commands_that_do_not_share_their_work") {
  FakeTeam fake(2);
  for (std::uint32_t rank : {0u, 1u})
    for (const char* word : {"bench", "bake", "view", "serve", "plan", "compare", "--help", "help", "version",
                             "reference", "accuracy", "render"}) {
      CAPTURE(rank);
      CAPTURE(word);
      const std::string name = word;
      const bool is_shared = name == "reference" || name == "accuracy" || name == "render" || name == "serve",
                 is_help = name == "--help" || name == "help" || name == "version";
      bool is_needed;
      Status status = check_team_command(fake.of(rank), word, &is_needed);
      CHECK(status.ok == (is_shared || is_help));
      if (!status.ok) CHECK(std::string(status.message).find("`" + name + "`") == 0);
      if (status.ok) CHECK(is_needed == (is_shared || rank == 0));
      CHECK(check_team_command(Team(), word, &is_needed).ok);
      CHECK(is_needed);
    }
}

// Goal: a program knows whether mpirun started it, and is not misled by other text.
TEST_CASE("team_launch_reads_the_environment") {
  struct Row {
    const char *size, *rank;
    std::uint32_t expected_size, expected_rank;
  };
  for (const Row& row :
       {Row{"3", "2", 3, 2}, Row{"1", "0", 1, 0}, Row{"x", "0", 1, 0}, Row{"2", "2", 1, 0}, Row{"", "", 1, 0}}) {
    CAPTURE(row.size);
    setenv("OMPI_COMM_WORLD_SIZE", row.size, 1);
    setenv("OMPI_COMM_WORLD_RANK", row.rank, 1);
    TeamLaunch launch = team_launch();
    CHECK(launch.size == row.expected_size);
    CHECK(launch.rank == row.expected_rank);
  }
  unsetenv("OMPI_COMM_WORLD_SIZE");
  CHECK(team_launch().size == 1);
  unsetenv("OMPI_COMM_WORLD_RANK");
}

// Goal: numbers and text arrive as sent; every message that is cut is known to be.
TEST_CASE("team_messages_that_are_cut_are_known_to_be") {
  TeamWriter text;
  text.number(0x123456789abcdefull), text.real(-0.1), text.text("a scene");
  for (std::size_t cut = 0; cut <= text.bytes().size(); ++cut) {
    CAPTURE(cut);
    TeamMessage message = message_of(text);
    message.bytes.resize(message.bytes.size() - cut);
    TeamReader reader(message);
    std::uint64_t number = reader.number();
    double real = reader.real();
    std::string word = reader.text();
    CHECK(reader.ok() == (cut == 0));
    if (cut > 0) continue;
    CHECK(number == 0x123456789abcdefull);
    CHECK(real == -0.1);
    CHECK(word == "a scene");
    CHECK(reader.left() == 0);
  }
}
