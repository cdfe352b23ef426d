// The server's log: one line an event, and no more of them than a disk can bear, however many bad clients come.
#pragma once
#include <cstdint>

#include "platform/link.h"

namespace pocketray {

constexpr int kLogBurst = 40;                            // lines at once
constexpr std::uint64_t kLogIntervalNs = 1'000'000'000;  // and from then on one for each of these

struct ServerLog {
  void (*write)(void* context, const char* line) = nullptr;  // null: nothing is logged
  void* context = nullptr;
  int line_count_left = kLogBurst;
  std::uint64_t left_out_count = 0;
  platform::LinkTimer next;  // when there may be one more line
};

// Writes a line, or counts it as left out: the next that is written says how many were.
__attribute__((format(printf, 3, 4))) void log_line(ServerLog* log, std::uint64_t now_ns, const char* format, ...);

}  // namespace pocketray
