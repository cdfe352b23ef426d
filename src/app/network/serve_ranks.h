// `serve` on the ranks that mpirun started. Only builds with MPI contain it.
#pragma once
#include <functional>
#include <string>

#include "base/status.h"
#include "remote/server/server.h"
#include "session/team.h"

namespace pocketray {

// Access of rank 0 to the others; empty functions: it is alone.
struct ServeCluster {
  const HelperRanks* helpers = nullptr;
  std::function<Status(const SceneStore&)> welcome;  // sends them the scenes and waits for them
  std::function<Status()> tend;                      // between steps of the server
  std::uint32_t rank_count = 1;
  std::function<std::uint32_t()> thread_count;  // of all ranks
  std::function<double()> helped_share;         // fraction of the pixels that the others traced
};

struct ClusterOptions {
  ServerOptions server;
  std::uint64_t scene_bytes_max = 0;
  std::string identity;  // equal on ranks started with the same options
};

// Runs lead() on rank 0 and helps it on the others; first calls read_options() on each. Returns the exit status.
int serve_on_ranks(const Team& team, const std::function<Status(ClusterOptions*)>& read_options,
                   const std::function<int(const ClusterOptions&, const ServeCluster&)>& lead);
using ServeOnRanks = decltype(&serve_on_ranks);

}  // namespace pocketray
