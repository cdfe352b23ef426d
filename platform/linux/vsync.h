// Waits for the screen's vertical blank and always returns, whatever the driver does. Some drivers return at once, some
// never, and no signal interrupts a call that hangs in the kernel: so a helper thread makes the call, and we wait for
// that thread for a bounded time.
#pragma once
#include <cstdint>

#include "platform/linux/driver.h"

namespace platform {

enum class VsyncKind : std::uint8_t {
  works,    // it takes about a frame
  absent,   // the driver refuses the call
  at_once,  // it returns without waiting
  never,    // it did not return in time; the helper thread may still be stuck in it
};

// Starts the helper and times a few waits. Takes up to four frames, or the timeout.
VsyncKind vsync_start(const Driver& driver, int file);
// The frame period measured by vsync_start(); 0 unless the wait works.
std::uint64_t vsync_period_ns();
// Waits for the next vertical blank, at most for the driver's timeout; after the first failure it returns at once.
VsyncKind vsync_wait();
void vsync_stop();

}  // namespace platform
