#pragma once
#include "platform/devices/device.h"

namespace platform {

// The client measured in [Aranha07] sec. 4: a tablet PC, Pentium M at 1 GHz, 502 MB, rendering at 320 × 240.
// The paper names neither its screen's depth nor its order: a PC's.
constexpr Device kTablet = {
    "tablet", "The tablet PC of Aranha et al.: Pentium M 1 GHz", "x86-64", 320, 240, 32, "rgb", 0, mebibytes(251),
    nullptr};

}  // namespace platform
