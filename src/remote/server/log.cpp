#include "remote/server/log.h"

#include <cinttypes>
#include <cstdarg>
#include <cstdio>

#include "base/check.h"

namespace pocketray {

void log_line(ServerLog* log, std::uint64_t now_ns, const char* format, ...) {
  if (!log->write) return;
  CHECK(log->line_count_left >= 0 && log->line_count_left <= kLogBurst);
  while (log->line_count_left < kLogBurst && platform::link_timer_left(&log->next, now_ns) == 0) {
    std::uint64_t over_ns = log->next.passed_ns - log->next.timeout_ns;
    log->next = platform::link_timer(now_ns, kLogIntervalNs);
    log->next.passed_ns = over_ns;
    ++log->line_count_left;
  }
  if (log->line_count_left == 0) {
    ++log->left_out_count;
    return;
  }
  if (log->line_count_left-- == kLogBurst) log->next = platform::link_timer(now_ns, kLogIntervalNs);
  char line[640];
  va_list arguments;
  va_start(arguments, format);
  int length = std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  if (log->left_out_count > 0 && length >= 0 && length < static_cast<int>(sizeof line))
    std::snprintf(line + length, sizeof line - static_cast<std::size_t>(length),
                  " (%" PRIu64 " lines before it omitted)", log->left_out_count);
  log->left_out_count = 0;
  log->write(log->context, line);
}

}  // namespace pocketray
