#pragma once
#include "platform/devices/device.h"

namespace platform {

// The buttons of OpenDingux, which its kernel reports as keys (od-contrib/linux, arch/mips/boot/dts/ingenic/bits/
// gcw0-base.dtsi): A Ctrl, B Alt, X Space, Y Shift, L Tab, R Backspace, start Enter, select Esc.
constexpr std::uint16_t kOpenDinguxKeys[] = {key::kUp,          key::kDown,      key::kLeft,  key::kRight,
                                             key::kLeftControl, key::kLeftAlt,   key::kSpace, key::kLeftShift,
                                             key::kTab,         key::kBackspace, key::kEnter, key::kEscape};

}  // namespace platform
