// The emulator: a window scaled by whole numbers, keyboard and game controllers as the handheld's buttons. Also works
// with SDL's dummy video driver.
#pragma once
#include "platform/platform.h"

namespace platform {

extern const Backend kSdl2Backend;

}  // namespace platform
