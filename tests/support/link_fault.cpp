#include "support/link_fault.h"

#include "platform/check.h"
#include "platform/null/net/null_state.h"

namespace pocketray {

using namespace platform;

void draw_link_faults(std::uint64_t seed, int connection_count, std::uint64_t byte_count, NullFault* faults,
                      int fault_count) {
  PLATFORM_CHECK(connection_count > 0 && byte_count > 0);
  for (int i = 0; i < fault_count; ++i) {
    faults[i].fault = static_cast<LinkFault>(random_u64(&seed) % kLinkFaultCount);
    faults[i].connection = static_cast<int>(random_u64(&seed) % static_cast<std::uint64_t>(connection_count));
    faults[i].to_device = random_u64(&seed) % 2 == 0;
    faults[i].at_byte = random_u64(&seed) % byte_count;
  }
}

const char* link_fault_name(LinkFault fault) {
  PLATFORM_CHECK_LT(static_cast<int>(fault), kLinkFaultCount);
  static const char* const kNames[kLinkFaultCount] = {"refuse",    "no answer", "reset",   "truncate",  "flip",
                                                      "duplicate", "silence",   "trickle", "clock back"};
  return kNames[static_cast<int>(fault)];
}

}  // namespace pocketray
