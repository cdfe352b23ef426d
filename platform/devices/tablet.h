#pragma once
#include "platform/devices/device.h"

namespace platform {

// The client measured in [Aranha07] sec. 4: a tablet PC, Pentium M at 1 GHz, 502 MB, rendering at 320 × 240.
// The paper gives neither the depth nor the channel order of its screen: a PC's.
// CPU: table 1, Cornell box: 8841 ns per pixel against 989 on two cores of 3 GHz, 8841 / (2 × 989) for each of them.
// (The Buddha, 6688 and 520, gives 6.43; four and eight cores give less for both.) Link: 802.11g with 19 Mbit/s on
// average (sec. 4). At that rate its T_t of 400 ns carries 0.95 bytes: a pixel of four bytes compressed 4:1. Latency
// and jitter are guesses: the paper has none.
// Energy: the thermal design power of an ultra low voltage Pentium M at 1 GHz (Intel, "Pentium M Processor Datasheet",
// 252612), an upper bound.
constexpr Device kTablet = {"tablet",
                            "The tablet PC of Aranha et al.: Pentium M 1 GHz",
                            "x86-64",
                            320,
                            240,
                            32,
                            "rgb",
                            0,
                            mebibytes(251),
                            nullptr,
                            1,
                            4.47,
                            2'375'000,
                            microseconds(1500),
                            microseconds(1000),
                            5,
                            410,
                            335,
                            107,
                            7,
                            kRadioNanojoules};

}  // namespace platform
