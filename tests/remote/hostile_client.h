// A hostile client of a server that consumes its CPU, its places or its patience.
#pragma once
#include <vector>

#include "fault_plan.h"
#include "fault_random.h"
#include "platform/link.h"
#include "wire/message.h"

namespace pocketray {

struct HostileClient {
  Neighbour is;
  ContentHash scene;
  int stream = -1;
  FaultRandom random = {1};
  std::vector<std::uint8_t> out;
  std::uint32_t frame = 0;
};

// Connects if necessary, and acts.
void step_hostile_client(platform::Link* link, const platform::LinkAddress& server, HostileClient* client);
void close_hostile_client(platform::Link* link, HostileClient* client);

}  // namespace pocketray
