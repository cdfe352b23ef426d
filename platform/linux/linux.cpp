#include "platform/linux/linux.h"

#include <fcntl.h>

#include "platform/check.h"
#include "platform/linux/console.h"
#include "platform/linux/evdev.h"
#include "platform/linux/fbdev.h"

namespace platform {
namespace {

struct State {
  const Driver* driver = &kSystemDriver;
  Framebuffer framebuffer;
  InputQueue input;
  bool open = false;
  bool quit_told = false;
};
State state;

bool usable() {
  int file = state.driver->open("/dev/fb0", O_RDWR);
  if (file < 0) return false;
  state.driver->close(file);
  return true;
}

void close() {
  if (!state.open) return;
  state.open = false;
  input_close(&state.input);
  framebuffer_close(&state.framebuffer);
  console_close();  // last: the console then draws itself anew over what we leave
}

bool open(const ScreenOptions& options, ScreenFormat* format, Error* error) {
  close();
  console_open(*state.driver);  // first: its cursor must not blink into the picture
  if (!framebuffer_open(*state.driver, options, &state.framebuffer, format, error)) {
    console_close();
    return false;
  }
  input_open(*state.driver, options.keys, &state.input);
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
    event->time_ns = state.driver->now_ns();
    return true;
  }
  return input_poll(&state.input, event);
}

std::uint64_t now_ns() { return state.driver->now_ns(); }
void sleep_ns(std::uint64_t duration) { state.driver->sleep_ns(duration); }

}  // namespace

void linux_set_driver(const Driver* driver) {
  close();
  state.driver = driver ? driver : &kSystemDriver;
}

const Backend kLinuxBackend = {"linux",     "a framebuffer, /dev/fb0, that this user may write",
                               usable,      open,
                               begin_frame, end_frame,
                               poll,        now_ns,
                               sleep_ns,    close};

}  // namespace platform
