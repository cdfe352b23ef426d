// Time that the system has given this thread. Standard types only.
#pragma once
#include <cstdint>

namespace platform {

// Nanoseconds for which the calling thread has had a CPU, by a clock that stands still while others have it.
std::uint64_t thread_cpu_ns();

}  // namespace platform
