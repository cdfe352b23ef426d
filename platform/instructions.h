// Counts the instructions of this process, if CPU and system allow it: a measure of work that neither clock rates nor
// other programs disturb. Standard types only.
#pragma once
#include <cstdint>

namespace platform {

// Starts counting the user-mode instructions of the calling thread and of threads it starts later. False: not
// available, as on many virtual machines. Once per process; a second call returns the result of the first.
bool start_instruction_count();

// Instructions so far; 0 without counting.
std::uint64_t instruction_count();

}  // namespace platform
