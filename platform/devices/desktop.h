#pragma once
#include "platform/devices/device.h"

namespace platform {

// Any PC on Ethernet of 1 Gbit/s: 941 Mbit/s by iperf3 (mpr-projects.com, "RPi NAS: Part 3 Network Connections",
// 2023). A window of the handhelds' size, and enough memory for every scene.
// Energy: guesses.
constexpr Device kDesktop = {"desktop",
                             "A PC with a window or a framebuffer",
                             "x86-64",
                             320,
                             240,
                             32,
                             "rgb",
                             0,
                             mebibytes(512),
                             nullptr,
                             0,
                             1,
                             117'500'000,
                             microseconds(100),
                             0,
                             1.1,
                             92,
                             75,
                             24,
                             10,
                             10};

}  // namespace platform
