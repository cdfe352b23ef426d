#pragma once
#include "platform/devices/device.h"

namespace platform {

// MagicEyes MMSP2: ARM920T at 200 MHz without FPU, 64 MiB of which the stock firmware leaves Linux 32; LCD 320 × 240
// RGB565. Shown in [Aranha07] fig. 1. Its ARMv4T core is older than Debian's armel (ARMv5TE): needs a compiler set for
// it. The stock kernel 2.4 has the stick at /dev/GPIO; evdev comes with the 2.6 kernels made for it.
constexpr Device kGp2x = {
    "gp2x", "GamePark GP2X: ARM920T 200 MHz, no FPU", "armel", 320, 240, 16, "rgb", 0, mebibytes(16), nullptr};

}  // namespace platform
