#pragma once
#include "platform/devices/device.h"

namespace platform {

// MagicEyes MMSP2: ARM920T at 200 MHz without FPU, 64 MiB of which the stock firmware leaves Linux 32; LCD 320 × 240
// RGB565. Shown in [Aranha07] fig. 1. Its ARMv4T core is older than Debian's armel (ARMv5TE): needs a compiler set for
// it. The stock kernel 2.4 has the stick at /dev/GPIO; evdev comes with the 2.6 kernels made for it.
// CPU: 2 clocks per instruction, a guess: 1.1 DMIPS/MHz (ARM) where all fits its caches of 16 KiB, which a scene does
// not. Link: it has no radio; by USB as a network card. USB 1.1 carries at most 19 packets of 64 bytes a millisecond
// (USB 2.0 specification, sec. 5.8.4), 1.2 MB/s, of which headers and host leave about 1. Its successor, the Wiz,
// answers a ping by the same Linux driver in 0.98 ms (gp32x.com, topic 50468, 2009).
constexpr Device kGp2x = {"gp2x",
                          "GamePark GP2X: ARM920T 200 MHz, no FPU",
                          "armel",
                          320,
                          240,
                          16,
                          "rgb",
                          0,
                          mebibytes(16),
                          nullptr,
                          1,
                          2800,
                          1'000'000,
                          microseconds(500),
                          microseconds(500)};

}  // namespace platform
