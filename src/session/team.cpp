#include "session/team.h"

#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "engine/workers.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

// Chosen: longer than a helper takes to finish its last work. One that is still opening a large scene after a failure
// is not waited for.
constexpr double kFarewellSeconds = 10;
constexpr double kInterruptSeconds = 0.3;  // between checks for an interrupt

// Tells the helpers to leave and waits for them: MPI ends a program that leaves before messages to it have arrived.
void dismiss(const Team& team, int exit_status) {
  TeamWriter text;
  text.number(static_cast<std::uint64_t>(exit_status));
  for (std::uint32_t rank = 1; rank < team.size; ++rank)
    send_to(team, rank, kTeamStop, text.bytes().data(), text.bytes().size());
  const std::uint64_t start = clock_ns();
  for (std::uint32_t gone = 0; gone + 1 < team.size;) {
    TeamMessage message;
    if (team.backend->receive(team.context, kInterruptSeconds, &message))
      gone += message.bytes[0] == kTeamGone;
    else if (exit_status != 0 && static_cast<double>(clock_ns() - start) > kFarewellSeconds * 1e9)
      abort_team(team, exit_status);
  }
}

void tell_failure(const Team& team, const Status& status) {
  send_to(team, 0, kTeamFailed, status.message, std::strlen(status.message));
}

int help(const Team& team, const std::function<Status()>& open, const std::function<Status(const TeamMessage&)>& work) {
  Status status = open();
  if (!status.ok) tell_failure(team, status);
  for (bool told = false;;) {
    TeamMessage message;
    if (!team.backend->receive(team.context, kInterruptSeconds, &message)) {
      if (interrupted && !told) send_to(team, 0, kTeamInterrupted, nullptr, 0), told = true;
      continue;
    }
    CHECK(!message.bytes.empty());
    if (message.bytes[0] == kTeamStop) {
      send_to(team, 0, kTeamGone, nullptr, 0);
      return static_cast<int>(TeamReader(message).number());
    }
    if (!status.ok) continue;
    status = work(message);
    if (!status.ok) tell_failure(team, status);
  }
}

}  // namespace

void send_to(const Team& team, std::uint32_t rank, std::uint8_t kind, const void* bytes, std::size_t byte_count) {
  CHECK(team.backend != nullptr);
  CHECK(rank < team.size && rank != team.rank);
  std::vector<std::uint8_t> all(1 + byte_count, kind);
  if (byte_count > 0) std::memcpy(all.data() + 1, bytes, byte_count);
  team.backend->send(team.context, rank, all.data(), all.size());
}

Status receive_from_helpers(const Team& team, double seconds, TeamMessage* message, bool* there) {
  CHECK(leads(team) && message != nullptr && there != nullptr);
  *there = team.size > 1 && team.backend->receive(team.context, seconds, message);
  if (!*there) return success();
  CHECK(!message->bytes.empty());
  const std::uint8_t kind = message->bytes[0];
  if (kind >= kTeamFirstOwn) return success();
  *there = false;
  if (kind == kTeamInterrupted) return interrupted.store(true), success();
  CHECK_EQ(static_cast<int>(kind), static_cast<int>(kTeamFailed));
  const std::string text(message->bytes.begin() + 1, message->bytes.end());
  return failure("rank %u: %s", message->from, text.c_str());
}

TeamLaunch team_launch() {
  TeamLaunch launch;
  const char *size = std::getenv("OMPI_COMM_WORLD_SIZE"), *rank = std::getenv("OMPI_COMM_WORLD_RANK");
  std::uint32_t is, of;
  if (!size || !rank || std::sscanf(size, "%9u", &of) != 1 || std::sscanf(rank, "%9u", &is) != 1) return launch;
  if (is < of) launch = {is, of};
  return launch;
}

Status check_team_command(const Team& team, const char* word, bool* is_needed) {
  CHECK(is_needed != nullptr);
  *is_needed = true;
  if (team.size == 1) return success();
  for (const char* shared : {"reference", "accuracy", "render", "serve"})
    if (word && std::strcmp(word, shared) == 0) return success();
  *is_needed = leads(team);
  if (!word || word[0] == '-') return success();  // help, or an error
  if (std::strcmp(word, "help") == 0 || std::strcmp(word, "version") == 0) return success();
  return failure(
      "`%.40s` does not run on several ranks, only reference, accuracy, render and serve do: start it without mpirun",
      word);
}

int run_in_team(const Team& team, const std::function<int()>& lead, const std::function<Status()>& open,
                const std::function<Status(const TeamMessage&)>& work) {
  CHECK_LT(team.rank, team.size);
  if (!leads(team)) return help(team, open, work);
  const int exit_status = lead();
  if (team.size > 1) dismiss(team, exit_status);
  return exit_status;
}

void abort_team(const Team& team, int exit_status) {
  if (team.size > 1) team.backend->abort(team.context, exit_status);
}

std::uint32_t team_threads(const Team& team, std::uint32_t asked) { return asked > 0 ? asked : team.core_count; }

void TeamWriter::append(const void* bytes, std::size_t byte_count) {
  const auto* from = static_cast<const std::uint8_t*>(bytes);
  bytes_.insert(bytes_.end(), from, from + byte_count);
}

bool TeamReader::take(void* bytes, std::size_t byte_count) {
  CHECK(bytes != nullptr || byte_count == 0);
  ok_ = ok_ && byte_count <= left();
  if (!ok_) return false;
  if (byte_count > 0) std::memcpy(bytes, message_.bytes.data() + at_, byte_count);
  at_ += byte_count;
  return true;
}

std::uint64_t TeamReader::number() {
  std::uint64_t value = 0;
  take(&value, sizeof value);
  return value;
}

double TeamReader::real() {
  double value = 0;
  take(&value, sizeof value);
  return value;
}

std::string TeamReader::text() {
  const std::uint64_t length = number();
  ok_ = ok_ && length <= left();
  std::string value(ok_ ? static_cast<std::size_t>(length) : 0, ' ');
  take(&value[0], value.size());
  return value;
}

}  // namespace pocketray
