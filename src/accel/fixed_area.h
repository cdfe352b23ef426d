// Tells whether a triangle has area, for CPUs without floating point.
#pragma once
#include <initializer_list>

#include "base/fixed_point.h"
#include "base/vec3.h"

namespace pocketray {

// Returns true only if the corners are not collinear: a component of the cross product of two edges exceeds its error.
// Corners are cut to units of 2^-28 of the power of two above all coordinates, so edges are wrong by less than 2 units.
// (is_degenerate() rounds, too, but by less than a unit times an edge.)
inline bool surely_has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  std::uint32_t most = 0;
  for (const Vec3* p : {&a, &b, &c})
    for (float x : {p->x, p->y, p->z}) most = magnitude_bits(x) > most ? magnitude_bits(x) : most;
  const int exponent = static_cast<int>(most >> 23);
  if (exponent < kFixedExponentMin || exponent == 255) return false;
  std::int32_t u[3], v[3];
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t from = to_fixed((&a.x)[axis], exponent);
    u[axis] = to_fixed((&b.x)[axis], exponent) - from, v[axis] = to_fixed((&c.x)[axis], exponent) - from;
  }
  auto exceeds = [&](int i, int j) {
    const std::int64_t cross = product(u[i], v[j]) - product(u[j], v[i]);
    const std::uint64_t sum = std::uint64_t(magnitude(u[i])) + magnitude(u[j]) + magnitude(v[i]) + magnitude(v[j]);
    return (cross < 0 ? 0 - static_cast<std::uint64_t>(cross) : static_cast<std::uint64_t>(cross)) > 3 * sum + 16;
  };
  return exceeds(0, 1) || exceeds(1, 2) || exceeds(2, 0);
}

}  // namespace pocketray
