#include "platform/instructions.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace platform {
namespace {

constexpr int kNotTried = -2;
int counter = kNotTried;

}  // namespace

bool start_instruction_count() {
  if (counter != kNotTried) return counter >= 0;
  perf_event_attr attributes = {};
  attributes.size = sizeof attributes;
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.inherit = 1;  // include threads started later
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  counter = static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
  return counter >= 0;
}

std::uint64_t instruction_count() {
  std::uint64_t count = 0;
  if (counter < 0 || read(counter, &count, sizeof count) != static_cast<ssize_t>(sizeof count)) return 0;
  return count;
}

}  // namespace platform
