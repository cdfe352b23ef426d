// Processes that work together on one command: the ranks that `mpirun -n N pocketray …` starts, or a single process.
// Rank 0 leads: it alone prints, writes results and decides; the others help. app/mpi has the backend; builds without
// MPI have none.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/status.h"

namespace pocketray {

struct TeamMessage {
  std::uint32_t from = 0;           // rank
  std::vector<std::uint8_t> bytes;  // not empty: the first byte is its kind
};

struct TeamBackend {
  // Copies the message and returns soon, whether or not it has arrived.
  // Messages between two ranks keep their order.
  void (*send)(void* context, std::uint32_t to, const std::uint8_t* bytes, std::size_t byte_count);
  // Takes the next message from any rank. Waits at most `seconds`, without spinning; returns false if none came.
  bool (*receive)(void* context, double seconds, TeamMessage* message);
  // Ends all ranks at once.
  void (*abort)(void* context, int exit_status);
};

struct Team {
  std::uint32_t rank = 0, size = 1;
  std::uint32_t core_count = 0;          // for this rank; 0: all
  const TeamBackend* backend = nullptr;  // null: a single process
  void* context = nullptr;               // the backend's
};

// How mpirun started this process, according to its environment: alone if it did not.
struct TeamLaunch {
  std::uint32_t rank = 0, size = 1;
};
TeamLaunch team_launch();

// Fails if several ranks must not run this command: they would overwrite each other's files. *is_needed: this rank
// takes part in it. `word` is the first on the command line; null: none.
Status check_team_command(const Team& team, const char* word, bool* is_needed);

inline bool leads(const Team& team) { return team.rank == 0; }

// Message kinds common to all commands; a command's own begin at kTeamFirstOwn.
enum TeamWord : std::uint8_t { kTeamStop, kTeamGone, kTeamFailed, kTeamInterrupted, kTeamFirstOwn };

// The rank must be another one of the team.
void send_to(const Team& team, std::uint32_t rank, std::uint8_t kind, const void* bytes, std::size_t byte_count);

// For the leader: takes the next message of a command's own kind; *there is false if none came in time. Fails, naming
// the rank, if a helper has failed. If a helper was interrupted, so is this process.
Status receive_from_helpers(const Team& team, double seconds, TeamMessage* message, bool* there);

// Runs a command: on rank 0 lead(), which returns the exit status of all ranks and leaves only dismissing the others;
// on the others open(), then work(message) for each message of the command's own kind until the leader dismisses them.
// A failure of either is reported to the leader, and nothing else is done then. An exception on any rank must end the
// program by abort_team().
int run_in_team(const Team& team, const std::function<int()>& lead, const std::function<Status()>& open,
                const std::function<Status(const TeamMessage&)>& work);

// Ends all ranks at once, if there are several.
void abort_team(const Team& team, int exit_status);

// Threads for a rank if the user leaves their number open (0): one for each of its cores.
std::uint32_t team_threads(const Team& team, std::uint32_t asked);

// Messages as bytes. Ranks run the same program on CPUs of one kind, so numbers are sent as they are in memory.
class TeamWriter {
 public:
  void number(std::uint64_t value) { append(&value, sizeof value); }
  void real(double value) { append(&value, sizeof value); }
  void text(const std::string& value) { number(value.size()), append(value.data(), value.size()); }
  void append(const void* bytes, std::size_t byte_count);
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Reads what follows a message's kind. Past its end it reads zeros, and ok() is false.
class TeamReader {
 public:
  explicit TeamReader(const TeamMessage& message) : message_(message) {}
  std::uint64_t number();
  double real();
  std::string text();
  bool take(void* bytes, std::size_t byte_count);
  std::size_t left() const { return message_.bytes.size() - at_; }
  bool ok() const { return ok_; }

 private:
  const TeamMessage& message_;
  std::size_t at_ = 1;
  bool ok_ = true;
};

}  // namespace pocketray
