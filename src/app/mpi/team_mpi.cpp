// Uses only messages between two ranks: Open MPI's collective operations, and waiting for a message, use a whole core.
#include "app/mpi/team_mpi.h"

#include <mpi.h>
#include <sched.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <list>

#include "base/check.h"
#include "engine/workers.h"

namespace pocketray {
namespace {

constexpr int kTag = 1;
// Polling interval: 2 % of the time since the last message. Answers arrive quickly, a render server's next request is
// hardly delayed, and a long wait costs neither time nor caches of concurrent measurements (a poll takes some
// microseconds).
constexpr std::uint64_t kLookNsMin = 20'000, kLookNsMax = 20'000'000, kLookPart = 50;
// Maximum wait in MPI for a large message, which is only sent while its sender is inside MPI.
constexpr double kSendSeconds = 0.05;

struct Sent {
  MPI_Request request;
  std::vector<std::uint8_t> bytes;
};

struct MpiTeam {
  std::list<Sent> sent;        // not yet arrived
  std::uint64_t heard_ns = 0;  // when the last message arrived
};

void sleep_ns(std::uint64_t ns) {
  timespec t = {static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  nanosleep(&t, nullptr);
}

bool forget_arrived(MpiTeam* team) {
  for (auto sent = team->sent.begin(); sent != team->sent.end();) {
    int arrived = 0;
    MPI_Test(&sent->request, &arrived, MPI_STATUS_IGNORE);
    sent = arrived ? team->sent.erase(sent) : std::next(sent);
  }
  return team->sent.empty();
}

// Calls is_there() until it returns true or the time has passed; sleeps in between, longer as time passes since
// `since_ns`.
template <class IsThere>
bool look_for(double seconds, std::uint64_t since_ns, IsThere&& is_there) {
  const std::uint64_t start = clock_ns();
  while (!is_there()) {
    const std::uint64_t pause = std::max(kLookNsMin, std::min((clock_ns() - since_ns) / kLookPart, kLookNsMax));
    const double left = seconds - static_cast<double>(clock_ns() - start) * 1e-9;
    if (left <= 0) return false;
    sleep_ns(std::min(pause, static_cast<std::uint64_t>(left * 1e9) + 1));
  }
  return true;
}

void send(void* context, std::uint32_t to, const std::uint8_t* bytes, std::size_t byte_count) {
  MpiTeam* team = static_cast<MpiTeam*>(context);
  CHECK_LE(byte_count, static_cast<std::size_t>(INT_MAX));
  team->sent.push_back({MPI_REQUEST_NULL, {bytes, bytes + byte_count}});
  Sent& sent = team->sent.back();
  MPI_Isend(sent.bytes.data(), static_cast<int>(byte_count), MPI_BYTE, static_cast<int>(to), kTag, MPI_COMM_WORLD,
            &sent.request);
  look_for(kSendSeconds, clock_ns(), [&] { return forget_arrived(team); });
}

bool receive(void* context, double seconds, TeamMessage* message) {
  MpiTeam* team = static_cast<MpiTeam*>(context);
  MPI_Message handle;
  MPI_Status status;
  const bool there = look_for(seconds, team->heard_ns, [&] {
    forget_arrived(team);
    int is_there = 0;
    MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &is_there, &handle, &status);
    return is_there != 0;
  });
  if (!there) return false;
  int byte_count = 0;
  team->heard_ns = clock_ns();
  MPI_Get_count(&status, MPI_BYTE, &byte_count);
  CHECK_GT(byte_count, 0);
  message->from = static_cast<std::uint32_t>(status.MPI_SOURCE);
  message->bytes.resize(static_cast<std::size_t>(byte_count));
  MPI_Mrecv(message->bytes.data(), byte_count, MPI_BYTE, &handle, MPI_STATUS_IGNORE);
  return true;
}

void abort_all(void*, int exit_status) { MPI_Abort(MPI_COMM_WORLD, exit_status); }

const TeamBackend kMpiBackend = {send, receive, abort_all};

MpiTeam* the_team() {
  static MpiTeam team;
  return &team;
}

// Ranks on one machine share its cores.
std::uint32_t cores_of_rank() {
  MPI_Comm machine;
  int ranks = 1;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &ranks);
  MPI_Comm_free(&machine);
  cpu_set_t bound;
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  const long own = sched_getaffinity(0, sizeof bound, &bound) == 0 ? CPU_COUNT(&bound) : cores;
  return static_cast<std::uint32_t>(std::max(1L, std::min(own, cores / std::max(1, ranks))));
}

}  // namespace

Status join_mpi_team(Team* team) {
  CHECK(team != nullptr && team->backend == nullptr);
  int given = 0, rank = 0, size = 1;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given) != MPI_SUCCESS || given < MPI_THREAD_FUNNELED)
    return failure("Open MPI does not start");
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  CHECK(rank >= 0 && rank < size);
  *team = {static_cast<std::uint32_t>(rank), static_cast<std::uint32_t>(size), cores_of_rank(), &kMpiBackend,
           the_team()};
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"}) unsetenv(name);
  return success();
}

void leave_mpi_team() {
  while (!forget_arrived(the_team())) sleep_ns(kLookNsMin);
  MPI_Finalize();
}

}  // namespace pocketray
