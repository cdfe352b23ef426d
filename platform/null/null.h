// The null backend: a screen in memory, buttons from a script and a clock that runs only when told to. It is the
// template for a port and the harness of the tests: the same script gives the same events at the same times, always.
#pragma once
#include "platform/platform.h"

namespace platform {

extern const Backend kNullBackend;

struct NullSettings {
  ScreenFormat format;         // bits_per_pixel 0: what is wanted
  int line_padding_bytes = 0;  // after each row of the page
  void* screen = nullptr;      // what is shown is copied here, rows of line_bytes; null: nowhere
  std::size_t screen_bytes = 0;
  const Event* script = nullptr;  // by rising time_ns
  int script_count = 0;
  std::uint64_t clock_step_ns =
      1000;  // each now_ns() moves the clock on by this, so that loops that wait come to an end
  std::uint64_t frame_ns = 16'666'667;  // so does each end_frame(), by this
};

// Takes effect at the next open(). What the pointers point to stays the caller's.
void null_configure(const NullSettings& settings);

struct NullRecord {
  int frames_shown = 0;
  int line_bytes = 0;
  int row_begin = 0, row_end = 0;  // of the last end_frame()
  bool open = false;
};
const NullRecord& null_record();

}  // namespace platform
