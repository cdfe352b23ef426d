// Instructions that this process executes, where the CPU and the system count them for programs: a measure of work that
// neither clock rates nor other programs disturb. Standard types only.
#pragma once
#include <cstdint>

namespace platform {

// Counts from now on what the calling thread and the threads it starts later execute outside the system. False: nothing
// is counted here, as on many virtual machines. Once per process; a second call returns what the first did.
bool start_instruction_count();

// So far; 0 where nothing is counted.
std::uint64_t instruction_count();

}  // namespace platform
