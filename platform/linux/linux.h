// The Linux backend: framebuffer, console, evdev and the system's clock.
#pragma once
#include "platform/linux/driver.h"
#include "platform/platform.h"

namespace platform {

extern const Backend kLinuxBackend;

// System calls go to this driver from the next open() on; null: to the system.
void linux_set_driver(const Driver* driver);

}  // namespace platform
