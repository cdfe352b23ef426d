#pragma once
#include "platform/devices/device.h"

namespace platform {

// Broadcom BCM2835: ARM1176JZF-S at 1 GHz, 512 MiB (Raspberry Pi documentation). It has an FPU, but Debian's armhf is
// for ARMv7: ARMv6 takes the armel build. The screen is what hobby cases have: an ILI9341 panel on SPI, 320 × 240
// RGB565 by fbtft.
constexpr Device kPiZero = {
    "pi-zero", "Raspberry Pi Zero with an SPI panel: ARM1176 1 GHz", "armel", 320, 240, 16, "rgb", 0, mebibytes(256),
    nullptr};

}  // namespace platform
