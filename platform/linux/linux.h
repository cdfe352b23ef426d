// The Linux backend: framebuffer, console, evdev and the system's clock.
#pragma once
#include "platform/platform.h"

namespace platform {

extern const Backend kLinuxBackend;

}  // namespace platform
