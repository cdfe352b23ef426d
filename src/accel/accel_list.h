// One line per accelerator. The first is the default.
#pragma once
#include "accel/accel.h"

namespace pocketray {

extern const AccelInfo kBvhAccel, kBruteAccel;

inline const AccelInfo* const kAccelList[] = {&kBvhAccel, &kBruteAccel};

}  // namespace pocketray
