// Ranks of a cluster in one program, without threads: while rank 0 looks for a message, the others work, each at its
// own pace.
#pragma once
#include <doctest/doctest.h>

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "remote/cluster/helper.h"
#include "remote/cluster/lead.h"
#include "support/scripted_client.h"

namespace pocketray {

// Small scenes, which 64 ranks have soon: seesaw, cube, and one whose exposure must be measured.
const SceneStore& small_store();

struct VirtualRanks {
  struct Seat {
    VirtualRanks* ranks = nullptr;
    std::uint32_t rank = 0;
    std::uint32_t looks_per_message = 1;  // of rank 0, until it has done what a message asks for; 0: it does nothing
    std::uint32_t looks = 0;
    std::deque<TeamMessage> messages;
    std::unique_ptr<ClusterHelper> helper;
  };
  std::vector<std::unique_ptr<Seat>> seats;
  // Changes what a helper sends; false: it is lost.
  std::function<bool(std::uint32_t rank, std::vector<std::uint8_t>* bytes)> change;
  std::uint64_t message_count = 0;  // from helpers
  std::unique_ptr<ClusterLead> lead;
  std::vector<std::string> log;
  ServerOptions options;

  // `adapt` changes the options of a rank. Every frame is shared unless shared_ns_min is given.
  explicit VirtualRanks(std::uint32_t count, const ServerOptions& given = ServerOptions(),
                        const std::function<void(std::uint32_t rank, ServerOptions*)>& adapt = {},
                        std::uint64_t shared_ns_min = 0);
  Team of(std::uint32_t rank);
  // Sends them the scenes. To be called once, before a server steps.
  Status welcome();
};

}  // namespace pocketray
