// One line per accelerator. The first is the default; if it does not fit into memory, the automatic ones after it are
// tried in order.
#pragma once
#include <cstring>

#include "accel/accel.h"

namespace pocketray {

extern const AccelInfo kBvhAccel, kCompactAccel, kGridAccel, kBruteAccel;

inline const AccelInfo* const kAccelList[] = {&kBvhAccel, &kCompactAccel, &kGridAccel, &kBruteAccel};

// Returns the accelerator that baked the data, or null.
inline const AccelInfo* accel_of(Array<const std::uint8_t> data) {
  std::uint32_t magic = 0;
  if (data.count >= sizeof magic) std::memcpy(&magic, data.data, sizeof magic);
  for (const AccelInfo* info : kAccelList)
    if (magic != 0 && info->magic == magic) return info;
  return nullptr;
}

}  // namespace pocketray
