#include "virtual_ranks.h"

#include <cstring>

#include "base/seal.h"
#include "scene/baked.h"
#include "scene/builtin_helpers.h"

namespace pocketray {
namespace {

using Seat = VirtualRanks::Seat;

void send(void* context, std::uint32_t to, const std::uint8_t* bytes, std::size_t byte_count) {
  Seat* seat = static_cast<Seat*>(context);
  TeamMessage message = {seat->rank, {bytes, bytes + byte_count}};
  if (to == 0) {
    ++seat->ranks->message_count;
    if (seat->ranks->change && !seat->ranks->change(seat->rank, &message.bytes)) return;
  }
  seat->ranks->seats[to]->messages.push_back(message);
}

void work(Seat* seat) {
  if (seat->looks_per_message == 0 || ++seat->looks % seat->looks_per_message != 0 || seat->messages.empty()) return;
  const TeamMessage message = seat->messages.front();
  seat->messages.pop_front();
  Status status = seat->helper->work(message);
  if (!status.ok) send_to(seat->ranks->of(seat->rank), 0, kTeamFailed, status.message, std::strlen(status.message));
}

bool receive(void* context, double seconds, TeamMessage* message) {
  Seat* seat = static_cast<Seat*>(context);
  REQUIRE(seat->rank == 0);
  for (int look = 0; look < (seconds > 0 ? 1000 : 1); ++look) {
    for (auto& other : seat->ranks->seats)
      if (other->helper) work(other.get());
    if (seat->messages.empty()) continue;
    *message = seat->messages.front();
    seat->messages.pop_front();
    return true;
  }
  return false;
}

const TeamBackend kVirtualBackend = {send, receive, [](void*, int) { std::abort(); }};

}  // namespace

const SceneStore& small_store() {
  static SceneStore store;
  if (!store.scenes.empty()) return store;
  for (const char* name : {"seesaw", "cube"}) REQUIRE(store_scene(name, name, false, 1u << 30, &store).ok);
  std::unique_ptr<BuiltScene> dim = build_builtin("seesaw");
  dim->scene.info.auto_exposure = 1;
  std::vector<std::uint8_t> bytes(baked_size(dim->scene));
  baked_write(dim->scene, bytes.data());
  REQUIRE(store_baked_scene("dim", bytes.data(), bytes.size(), 1u << 30, &store).ok);
  return store;
}

Status VirtualRanks::welcome() { return lead->welcome(small_store()); }

VirtualRanks::VirtualRanks(std::uint32_t count, const ServerOptions& given,
                           const std::function<void(std::uint32_t, ServerOptions*)>& adapt, std::uint64_t shared_ns_min)
    : options(given) {
  for (std::uint32_t rank = 0; rank < count; ++rank) {
    seats.push_back(std::make_unique<Seat>());
    seats.back()->ranks = this, seats.back()->rank = rank;
  }
  options.log = [](void* context, const char* line) {
    SealPause pause;
    static_cast<VirtualRanks*>(context)->log.push_back(line);
  };
  options.log_context = this;
  lead = std::make_unique<ClusterLead>(of(0), options, "the same", shared_ns_min);
  for (std::uint32_t rank = 1; rank < count; ++rank) {
    ServerOptions own = options;
    if (adapt) adapt(rank, &own);
    seats[rank]->helper = std::make_unique<ClusterHelper>(of(rank), own, 1u << 30, "the same");
    Status status = seats[rank]->helper->open();
    REQUIRE_MESSAGE(status.ok, status.message);
  }
  options.helpers = lead->helpers();
}

Team VirtualRanks::of(std::uint32_t rank) {
  return {rank, static_cast<std::uint32_t>(seats.size()), 1, &kVirtualBackend, seats[rank].get()};
}

}  // namespace pocketray
