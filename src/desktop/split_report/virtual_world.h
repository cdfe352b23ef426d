// Render servers and their clients in one simulated world: one link, one clock, emulated CPUs. The servers work while
// the device waits, so every run takes the same course, however busy this machine is.
#pragma once
#include <cstddef>
#include <vector>

#include "platform/null/net/null_link.h"
#include "remote/server/server.h"

namespace pocketray {

struct VirtualWorld;

// The simulated link as the device sees it.
struct WorldLink : platform::LinkBackend {
  VirtualWorld* world = nullptr;
};

struct VirtualWorld {
  std::vector<std::max_align_t> memory;
  WorldLink backend;
  platform::Link* link = nullptr;
  const SceneStore* store = nullptr;
  std::vector<Server*> servers;  // null: stopped
  std::vector<platform::LinkAddress> addresses;
  bool stepping = false;
  VirtualWorld() = default;
  VirtualWorld(const VirtualWorld&) = delete;
  VirtualWorld& operator=(const VirtualWorld&) = delete;
  ~VirtualWorld();
};

// Makes `server_count` servers without starting them. The caller keeps the store, which must outlive the world.
Status open_world(const platform::NullLinkSettings& line, const SceneStore& store, std::uint32_t server_count,
                  VirtualWorld* world);
// A restarted server listens at its previous address.
Status start_server(VirtualWorld* world, std::uint32_t index, const ServerOptions& options);
void stop_server(VirtualWorld* world, std::uint32_t index);

inline std::uint64_t world_now_ns(const VirtualWorld& world) { return platform::kNullLink.now_ns(world.link); }

}  // namespace pocketray
