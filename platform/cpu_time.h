// CPU time of this thread. Standard types only.
#pragma once
#include <cstdint>

namespace platform {

// Nanoseconds for which the calling thread has had a CPU.
std::uint64_t thread_cpu_ns();

}  // namespace platform
