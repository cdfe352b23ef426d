// The Linux backend: framebuffer, console, evdev and the system's clock.
#pragma once
#include "platform/linux/driver.h"
#include "platform/platform.h"

namespace platform {

extern const Backend kLinuxBackend;

// Uses this driver for system calls from the next open() on; null: the system's.
void linux_set_driver(const Driver* driver);

}  // namespace platform
