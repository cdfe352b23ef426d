// Random numbers for fault plans.
#pragma once
#include <cmath>
#include <cstdint>

#include "platform/net/link_pipe.h"

namespace pocketray {

struct FaultRandom {
  std::uint64_t state;
  std::uint64_t below(std::uint64_t n) { return platform::random_u64(&state) % n; }
  double real() { return static_cast<double>(platform::random_u64(&state) >> 11) * 0x1p-53; }
  // Log-uniform.
  double scale(double low, double high) { return low * std::pow(high / low, real()); }
};

}  // namespace pocketray
