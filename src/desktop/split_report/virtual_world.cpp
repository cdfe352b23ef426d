#include "desktop/split_report/virtual_world.h"

#include <algorithm>

#include "base/check.h"
#include "remote/server/state.h"

namespace pocketray {
namespace {

constexpr int kStreams = 64;
constexpr std::uint64_t kWaitingStepNs = 5'000;  // clock step while a party waits,
constexpr std::uint64_t kWaitedDivisor = 64;     // or this fraction of the time waited so far, if larger;
constexpr std::uint64_t kWorkingStepNs = 200;    // smaller while a server works, to end with its work

int poll_stepping(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  const platform::LinkBackend& net = platform::kNullLink;
  VirtualWorld* world = static_cast<const WorldLink*>(link->backend)->world;
  if (world->stepping) return net.poll(link, waits, wait_count, timeout_ns);
  world->stepping = true;
  std::uint64_t begin = net.now_ns(link);
  int ready = 0;
  for (;;) {
    std::uint64_t step = std::max(kWaitingStepNs, (net.now_ns(link) - begin) / kWaitedDivisor);
    for (Server* server : world->servers)
      if (server) {
        step_server(server, 0);
        step = std::min(step, std::max(kWorkingStepNs, work_due_ns(server)));
      }
    std::uint64_t passed = net.now_ns(link) - begin, left = passed < timeout_ns ? timeout_ns - passed : 0;
    ready = net.poll(link, waits, wait_count, std::min(left, step));
    if (ready > 0 || left <= step) break;
  }
  world->stepping = false;
  return ready;
}

}  // namespace

VirtualWorld::~VirtualWorld() {
  for (std::uint32_t i = 0; i < servers.size(); ++i) stop_server(this, i);
  if (link) platform::kNullLink.close_all(link);
}

Status open_world(const platform::NullLinkSettings& line, const SceneStore& store, std::uint32_t server_count,
                  VirtualWorld* world) {
  CHECK(world->link == nullptr);
  platform::LinkOptions options;
  options.memory_bytes = null_link_need(kStreams, line);
  world->memory.resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = world->memory.data();
  options.stream_count_max = kStreams;
  platform::Error error;
  world->link = null_link_open(options, line, &error);
  if (!world->link) return failure("%s", error.text);
  static_cast<platform::LinkBackend&>(world->backend) = platform::kNullLink;
  world->backend.poll = poll_stepping;
  world->backend.world = world;
  world->link->backend = &world->backend;
  world->store = &store;
  world->servers.assign(server_count, nullptr);
  world->addresses.resize(server_count);
  for (platform::LinkAddress& address : world->addresses)
    if (!platform::kNullLink.resolve(":0", &address, &error)) return failure("%s", error.text);
  return success();
}

Status start_server(VirtualWorld* world, std::uint32_t i, const ServerOptions& options) {
  CHECK_LT(i, world->servers.size());
  CHECK(world->servers[i] == nullptr);
  RETURN_IF_ERROR(open_server(options, *world->store, world->link, world->addresses[i], &world->servers[i]));
  platform::Error error;
  if (platform::kNullLink.resolve(server_address(*world->servers[i]), &world->addresses[i], &error)) return success();
  return failure("%s", error.text);
}

void stop_server(VirtualWorld* world, std::uint32_t i) {
  CHECK_LT(i, world->servers.size());
  world->stepping = true;  // it polls to say goodbye, and the others must wait for it
  close_server(world->servers[i]);
  world->servers[i] = nullptr;
  world->stepping = false;
}

}  // namespace pocketray
