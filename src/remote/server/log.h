// The server's log: one line per event, rate-limited so that bad clients cannot fill the disk.
#pragma once
#include <cstdint>

#include "platform/link.h"

namespace pocketray {

// Chosen: eight clients and sixteen guests, the defaults, can come or go at once without losing a line. At one line per
// second, of at most 640 bytes, the log then grows by at most 55 MB a day.
constexpr int kLogBurst = 40;                            // lines in a burst
constexpr std::uint64_t kLogIntervalNs = 1'000'000'000;  // then one line per interval

struct ServerLog {
  void (*write)(void* context, const char* line) = nullptr;  // null: no logging
  void* context = nullptr;
  int line_count_left = kLogBurst;
  std::uint64_t left_out_count = 0;
  platform::LinkTimer next;  // when the next line is allowed
};

// Writes a line, or counts it as omitted; the next line written reports the count.
__attribute__((format(printf, 3, 4))) void log_line(ServerLog* log, std::uint64_t now_ns, const char* format, ...);

}  // namespace pocketray
