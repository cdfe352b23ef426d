// Reads a file in a child process, so that a library that crashes, hangs or exhausts memory does no harm. The child
// returns a baked scene, which is checked as one.
#pragma once
#include <cstdint>
#include <functional>

#include "session/model_import.h"

namespace pocketray {

struct ContainerLimits {
  std::uint64_t memory_bytes;      // address space beyond current use; 0: no limit
  std::uint32_t cpu_seconds;       // processor time
  std::uint32_t elapsed_seconds;   // wall time: a reader that waits forever takes no processor time
  std::uint64_t result_bytes_max;  // size of the scene
};

// Calls `read` in a child process. Rethrows its exceptions as an ImportError with the same text; if the child crashes
// or exceeds a limit, throws an ImportError that says how.
void import_contained(const ContainerLimits& limits, const std::function<void(ImportedScene*)>& read,
                      ImportedScene* result);

}  // namespace pocketray
