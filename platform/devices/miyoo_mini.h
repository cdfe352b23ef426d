#pragma once
#include "platform/devices/device.h"

namespace platform {

// The stock firmware's layout: A Space, B Ctrl, X Shift, Y Alt, L E, R T, select right Ctrl; the menu key is Esc.
constexpr std::uint16_t kMiyooMiniKeys[] = {key::kUp,    key::kDown,        key::kLeft,      key::kRight,
                                            key::kSpace, key::kLeftControl, key::kLeftShift, key::kLeftAlt,
                                            key::kE,     key::kT,           key::kEnter,     key::kRightControl};

// SigmaStar SSD202D: two Cortex-A7 at 1.2 GHz with NEON, 128 MiB in the package; LCD 640 × 480, 32 bits, mounted upside
// down (its SDL port turns every frame by 180 degrees).
constexpr Device kMiyooMini = {
    "miyoo-mini",  "Miyoo Mini: two Cortex-A7 1.2 GHz, NEON", "armhf", 640, 480, 32, "rgb", 180, mebibytes(64),
    kMiyooMiniKeys};

}  // namespace platform
