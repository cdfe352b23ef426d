#include "platform/linux/linux.h"

#include <fcntl.h>

#include "platform/check.h"
#include "platform/linux/console.h"
#include "platform/linux/driver.h"
#include "platform/linux/evdev.h"
#include "platform/linux/fbdev.h"

namespace platform {
namespace {

struct State {
  Framebuffer framebuffer;
  InputQueue input;
  bool open = false;
  bool quit_told = false;
};
State state;

bool usable() {
  int file = linux_driver->open("/dev/fb0", O_RDWR);
  if (file < 0) return false;
  linux_driver->close(file);
  return true;
}

void close() {
  if (!state.open) return;
  state.open = false;
  input_close(&state.input);
  framebuffer_close(&state.framebuffer);
  console_close();  // last: the console then redraws itself over our picture
}

bool open(const ScreenOptions& options, ScreenFormat* format, Error* error) {
  close();
  console_open(*linux_driver);  // first: its cursor must not blink in the picture
  if (!framebuffer_open(*linux_driver, options, &state.framebuffer, format, error)) {
    console_close();
    return false;
  }
  input_open(*linux_driver, options.keys, &state.input);
  state.open = true;
  state.quit_told = false;
  return true;
}

Page begin_frame() { return framebuffer_begin_frame(&state.framebuffer); }
void end_frame(int row_begin, int row_end) { framebuffer_end_frame(&state.framebuffer, row_begin, row_end); }

bool poll(Event* event) {
  PLATFORM_CHECK(event != nullptr);
  if (console_quit_requested() && !state.quit_told) {
    state.quit_told = true;
    *event = Event();
    event->time_ns = linux_driver->now_ns();
    return true;
  }
  return input_poll(&state.input, event);
}

std::uint64_t now_ns() { return linux_driver->now_ns(); }
void sleep_ns(std::uint64_t duration) { linux_driver->sleep_ns(duration); }

}  // namespace

const Driver* linux_driver = &kSystemDriver;

const Backend kLinuxBackend = {"linux",     "a framebuffer, /dev/fb0, that this user may write to",
                               usable,      open,
                               begin_frame, end_frame,
                               poll,        now_ns,
                               sleep_ns,    close};

}  // namespace platform
