#include "scene/environment.h"

#include <cmath>

#include "base/check.h"

namespace pocketray {

std::uint32_t to_environment_texel(const Vec3d& color) {
  const double most = std::fmax(color.x, std::fmax(color.y, color.z));
  CHECK(color.x >= 0 && color.y >= 0 && color.z >= 0 && most <= static_cast<double>(kEnvironmentTexelMax));
  int exponent = 0;
  if (most > 0) std::frexp(most, &exponent);  // most < 2^exponent
  int stored = exponent + 15 > 0 ? exponent + 15 : 0;
  auto mantissa = [&](double x) { return static_cast<std::uint32_t>(std::floor(std::ldexp(x, 24 - stored) + 0.5)); };
  if (mantissa(most) > 511) ++stored;
  CHECK_LE(stored, 31);
  return mantissa(color.x) | mantissa(color.y) << 9 | mantissa(color.z) << 18 |
         static_cast<std::uint32_t>(stored) << 27;
}

}  // namespace pocketray
