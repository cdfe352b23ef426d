#pragma once
#include "platform/devices/opendingux.h"

namespace platform {

// Allwinner F1C100s: ARM926EJ-S, 32 MiB in the package (F1C100s datasheet, ch. 1); LCD 320 × 240 RGB565. 408 MHz and
// up. Also covers BittBoy, PocketGo and PowKiddy V90. The MiyooCFW firmware has the keys of OpenDingux.
// CPU: the armel build at 408 MHz.
// Link: a USB stick for 802.11n with one antenna. 16 Mbit/s, from the 10 to 20 that consumer 802.11g and n devices
// reached in an office (web.luchs.at, "Using 802.11n and WPA2"): its CPU is as slow as theirs. Latency and jitter are
// guesses.
// Energy: a guess: as much per MHz as the ARM1176 of pi_zero.h.
constexpr Device kMiyoo = {"miyoo",
                           "Miyoo and kin: F1C100s, ARM926EJ-S, no FPU",
                           "armel",
                           320,
                           240,
                           16,
                           "rgb",
                           0,
                           mebibytes(16),
                           kOpenDinguxKeys,
                           1,
                           228,
                           2'000'000,
                           microseconds(1500),
                           microseconds(2000),
                           86,
                           2200,
                           7600,
                           13'200,
                           0.08,
                           kRadioNanojoules};

}  // namespace platform
