// Reads a file in a process of its own, so that a library that crashes, runs wild or asks for all memory takes nothing
// with it. What comes back is a baked scene, and checked as one.
#pragma once
#include <cstdint>
#include <functional>

#include "import/import.h"

namespace pocketray {

struct ContainerLimits {
  std::uint64_t memory_bytes;      // of the address space, beyond what the program has already; 0: none
  std::uint32_t cpu_seconds;       // of processor time
  std::uint64_t result_bytes_max;  // of the scene
};

// Calls `read` in a child process. What it throws is thrown here as an ImportError of the same text; where the child
// comes to a bad end, an ImportError says to which.
void import_contained(const ContainerLimits& limits, const std::function<void(ImportedScene*)>& read,
                      ImportedScene* result);

}  // namespace pocketray
