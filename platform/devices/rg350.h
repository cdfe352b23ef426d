#pragma once
#include "platform/devices/opendingux.h"

namespace platform {

// Anbernic RG350 with OpenDingux: Ingenic JZ4770, a MIPS32 with FPU at up to 996 MHz unless overclocked, 512 MiB (the
// kernel's gcw0-base.dtsi, as for the keys); LCD 320 × 240, with 32 bits per pixel in the frame buffer. The GCW Zero
// and the RG280 do not differ in any relevant respect. CPU: the mips32 build.
// Link: it has no radio; through a USB stick for 802.11n with one antenna 37 Mbit/s, see miyoo_mini.h. Latency and
// jitter are guesses.
// Energy: a guess: as much per MHz as the ARM1176 of pi_zero.h.
constexpr Device kRg350 = {"rg350",
                           "Anbernic RG350: JZ4770, MIPS32 996 MHz",
                           "mips32",
                           320,
                           240,
                           32,
                           "rgb",
                           0,
                           mebibytes(256),
                           kOpenDinguxKeys,
                           1,
                           40,
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
