#include "platform/null/null.h"

#include <cstdio>
#include <cstring>

#include "platform/check.h"

namespace platform {
namespace {

struct State {
  NullSettings settings;
  NullRecord record;
  ScreenFormat format;
  unsigned char* page = nullptr;
  int events_taken = 0;
  std::uint64_t clock_ns = 0;
};
State state;

bool usable() { return true; }

void close() { state.record.open = false; }

bool open(const ScreenOptions& options, ScreenFormat* format, Error* error) {
  close();
  const NullSettings& settings = state.settings;
  bool turned = options.rotation == 90 || options.rotation == 270;
  int width = turned ? options.height : options.width;
  int height = turned ? options.width : options.height;

  // 1. The screen: as requested, or as limited by this screen.
  ScreenFormat screen = settings.format;
  if (screen.bits_per_pixel == 0) screen = screen_format(width, height, options.bits_per_pixel, options.blue_first);
  if (screen.width > width) screen.width = width;
  if (screen.height > height) screen.height = height;

  // 2. The page to draw into lies in the caller's memory. A backend whose hardware has its own pages needs none of it.
  int line_bytes = screen.width * (screen.bits_per_pixel / 8) + settings.line_padding_bytes;
  std::size_t bytes = static_cast<std::size_t>(line_bytes) * static_cast<std::size_t>(screen.height);
  if (!options.memory || options.memory_bytes < bytes) {
    std::snprintf(error->text, sizeof error->text, "the back page needs %zu bytes but %zu were given", bytes,
                  options.memory_bytes);
    return false;
  }
  if (settings.screen && settings.screen_bytes < bytes) {
    std::snprintf(error->text, sizeof error->text, "the screen needs %zu bytes, it has %zu", bytes,
                  settings.screen_bytes);
    return false;
  }

  // 3. Reset the rest: no frame was shown, no button is down, the clock is at zero.
  state.page = static_cast<unsigned char*>(options.memory);
  state.format = *format = screen;
  state.record = NullRecord();
  state.record.line_bytes = line_bytes;
  state.record.open = true;
  state.events_taken = 0;
  state.clock_ns = 0;
  return true;
}

// One page that is copied to the screen always holds the previous frame. Two pages that are exchanged would have age 2.
Page begin_frame() { return {state.page, state.record.line_bytes, state.record.frames_shown > 0 ? 1 : 0}; }

void end_frame(int row_begin, int row_end) {
  PLATFORM_CHECK(state.record.open);
  PLATFORM_CHECK(row_begin >= 0 && row_end <= state.format.height);
  NullRecord& record = state.record;
  if (state.settings.screen && row_begin < row_end) {
    std::size_t offset = static_cast<std::size_t>(row_begin) * static_cast<std::size_t>(record.line_bytes);
    std::size_t bytes = static_cast<std::size_t>(row_end - row_begin) * static_cast<std::size_t>(record.line_bytes);
    std::memcpy(static_cast<unsigned char*>(state.settings.screen) + offset, state.page + offset, bytes);
  }
  record.row_begin = row_begin;
  record.row_end = row_end;
  ++record.frames_shown;
  state.clock_ns += state.settings.frame_ns;
}

bool poll(Event* event) {
  PLATFORM_CHECK(event != nullptr);
  if (state.events_taken == state.settings.script_count) return false;
  const Event& next = state.settings.script[state.events_taken];
  if (next.time_ns > state.clock_ns) return false;
  *event = next;
  ++state.events_taken;
  return true;
}

std::uint64_t now_ns() { return state.clock_ns += state.settings.clock_step_ns; }

void sleep_ns(std::uint64_t duration) {
  state.clock_ns += duration;
  if (state.settings.rest_ns) state.settings.rest_ns(duration);
}

}  // namespace

void null_configure(const NullSettings& settings) { state.settings = settings; }

const NullRecord& null_record() { return state.record; }

const Backend kNullBackend = {"null", "nothing", usable, open, begin_frame, end_frame, poll, now_ns, sleep_ns, close};

}  // namespace platform
