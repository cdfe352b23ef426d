#pragma once
#include "platform/devices/device.h"

namespace platform {

// The stock firmware's layout: A Space, B Ctrl, X Shift, Y Alt, L E, R T, select right Ctrl; the menu key is Esc.
constexpr std::uint16_t kMiyooMiniKeys[] = {key::kUp,    key::kDown,        key::kLeft,      key::kRight,
                                            key::kSpace, key::kLeftControl, key::kLeftShift, key::kLeftAlt,
                                            key::kE,     key::kT,           key::kEnter,     key::kRightControl};

// SigmaStar SSD202D: two Cortex-A7 at 1.2 GHz with NEON, 128 MiB in the package; LCD 640 × 480, 32 bits, mounted upside
// down (its SDL port turns every frame by 180 degrees).
// CPU: the armhf build.
// Link: as in the Miyoo Mini Plus, 802.11n at 2.4 GHz with one antenna: 37 Mbit/s, typical of its kind in a channel of
// 20 MHz, out of at most 50 (tanaza.com, "Bitrate, throughput, bandwidth", 2014). Latency and jitter are guesses.
// Energy: a board with one Cortex-A7 at 528 MHz takes 200 mW more under a stress test than idle (wiki.dave.eu, "Power
// consumption (SBC Lynx)", 2016), memory included; here in proportion to the clock.
constexpr Device kMiyooMini = {"miyoo-mini",
                               "Miyoo Mini: two Cortex-A7 1.2 GHz, NEON",
                               "armhf",
                               640,
                               480,
                               32,
                               "rgb",
                               180,
                               mebibytes(64),
                               kMiyooMiniKeys,
                               2,
                               14,
                               4'625'000,
                               microseconds(1500),
                               microseconds(2000),
                               20,
                               725,
                               670,
                               290,
                               0.45,
                               kRadioNanojoules};

}  // namespace platform
