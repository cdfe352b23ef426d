#pragma once
#include "platform/devices/device.h"

namespace platform {

// Any PC: a window of the handhelds' size, and memory enough for every scene.
constexpr Device kDesktop = {
    "desktop", "A PC with a window or a framebuffer", "x86-64", 320, 240, 32, "rgb", 0, mebibytes(512), nullptr};

}  // namespace platform
