// Faults of the simulated link: their names, and faults drawn from a seed.
#pragma once
#include "platform/null/net/null_link.h"

namespace pocketray {

const char* link_fault_name(platform::LinkFault fault);

// Faults of any kind, each for one of the first `connection_count` connections, at one of its first `byte_count` bytes.
void draw_link_faults(std::uint64_t seed, int connection_count, std::uint64_t byte_count, platform::NullFault* faults,
                      int fault_count);

}  // namespace pocketray
