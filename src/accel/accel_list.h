// One line per accelerator. The first is the default; the next that are automatic take its place in their order where
// it does not fit the memory.
#pragma once
#include <cstring>

#include "accel/accel.h"

namespace pocketray {

extern const AccelInfo kBvhAccel, kCompactAccel, kBruteAccel;

inline const AccelInfo* const kAccelList[] = {&kBvhAccel, &kCompactAccel, &kBruteAccel};

// Whose baked data that is; null for nobody's.
inline const AccelInfo* accel_of(Array<const std::uint8_t> data) {
  std::uint32_t magic = 0;
  if (data.count >= sizeof magic) std::memcpy(&magic, data.data, sizeof magic);
  for (const AccelInfo* info : kAccelList)
    if (magic != 0 && info->magic == magic) return info;
  return nullptr;
}

}  // namespace pocketray
