#pragma once
#include "platform/devices/device.h"

namespace platform {

// Broadcom BCM2835: ARM1176JZF-S at 1 GHz, 512 MiB (Raspberry Pi documentation). It has an FPU, but Debian's armhf is
// for ARMv7: the armv6 build uses the FPU with the libraries of armel. The screen is common in hobby cases: an ILI9341
// panel on SPI, 320 × 240 RGB565, driven by fbtft. CPU: the clocks of the armv6 build. Link: as in the Zero W, 802.11n
// at 2.4 GHz with one antenna: 37 Mbit/s, see miyoo_mini.h. Energy: the board takes 100 mA idle and 140 mA when pushed,
// at 5.09 V (raspi.tv, "Raspberry Pi Zero power measurements", 2015).
constexpr Device kPiZero = {"pi-zero",
                            "Raspberry Pi Zero with an SPI panel: ARM1176 1 GHz",
                            "armv6",
                            320,
                            240,
                            16,
                            "rgb",
                            0,
                            mebibytes(256),
                            nullptr,
                            1,
                            32,
                            4'625'000,
                            microseconds(1500),
                            microseconds(2000),
                            35,
                            900,
                            800,
                            350,
                            0.2,
                            kRadioNanojoules};

}  // namespace platform
