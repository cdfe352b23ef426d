// The null backend: a screen in memory, buttons from a script and a clock that only advances on demand. It is the
// template for a port and the harness of the tests: a script always gives equal events at equal times.
#pragma once
#include "platform/platform.h"

namespace platform {

extern const Backend kNullBackend;

struct NullSettings {
  ScreenFormat format;         // bits_per_pixel 0: as requested
  int line_padding_bytes = 0;  // after each row of the page
  void* screen = nullptr;      // receives a copy of the shown picture, rows of line_bytes; null: none
  std::size_t screen_bytes = 0;
  const Event* script = nullptr;  // in order of time_ns
  int script_count = 0;
  std::uint64_t clock_step_ns = 1000;                 // advance of each now_ns(), so that busy-waiting loops end
  std::uint64_t frame_ns = 16'666'667;                // advance of each end_frame()
  void (*rest_ns)(std::uint64_t duration) = nullptr;  // lets that much time pass outside too; null: only the clock's
};

// Takes effect at the next open(). The caller keeps what the pointers refer to.
void null_configure(const NullSettings& settings);

struct NullRecord {
  int frames_shown = 0;
  int line_bytes = 0;
  int row_begin = 0, row_end = 0;  // of the last end_frame()
  bool open = false;
};
const NullRecord& null_record();

}  // namespace platform
