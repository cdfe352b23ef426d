#include "platform/null/null_state.h"

namespace platform {

namespace null_link {

// SplitMix64 [Steele, Lea, Flood 2014, fig. 17].
std::uint64_t random_u64(std::uint64_t* state) {
  std::uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace null_link

void null_link_draw_faults(std::uint64_t seed, int connection_count, std::uint64_t byte_count, NullFault* faults,
                           int fault_count) {
  for (int i = 0; i < fault_count; ++i) {
    faults[i].fault = static_cast<LinkFault>(null_link::random_u64(&seed) % kLinkFaultCount);
    faults[i].connection =
        static_cast<int>(null_link::random_u64(&seed) % static_cast<std::uint64_t>(connection_count));
    faults[i].to_device = null_link::random_u64(&seed) % 2 == 0;
    faults[i].at_byte = null_link::random_u64(&seed) % byte_count;
  }
}

const char* link_fault_name(LinkFault fault) {
  static const char* const kNames[kLinkFaultCount] = {"refuse",    "no answer", "reset",   "truncate",  "flip",
                                                      "duplicate", "silence",   "trickle", "clock back"};
  return kNames[static_cast<int>(fault)];
}

}  // namespace platform
