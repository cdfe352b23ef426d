// A ray in fixed point. Part of the kernels: see bvh_fixed.h.
//
// Coordinates are those of a class of rays (axis_class.h): x and y by kx and ky, z by kz, with the sign that makes the
// ray run towards larger z. From depth 0 at its origin to depth z it moves by (shear_x, shear_y)·z, both at most 1.
//
// Errors, in units: coordinates are cut by less than 1, differences of two by less than 2; shears by less than 2^-31, a
// product with a depth below 2^30 by less than 2.5. So a point seen from the ray errs by less than 5.
#pragma once
#include <limits>

#include "accel/leaf_ray.h"
#include "base/fixed_point.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

struct FixedFrame {
  int exponent;  // of the scale
  const Axes* axes;
  std::int32_t flip;  // −1 if the direction along kz is negative, else 0
};

// ~value differs from −value by a unit, which cancels in differences.
inline std::int32_t flipped(const FixedFrame& frame, std::int32_t value) { return value ^ frame.flip; }

struct FixedRay {
  std::int32_t x, y, z, shear_x, shear_y, size_x, size_y;  // size: |shear|
};

// Depth that bounds all hits up to t; see bound_depth() in leaf_ray.h.
inline std::int32_t depth_limit(float t, float direction_z, int exponent) {
  float far = (t + std::numeric_limits<float>::denorm_min()) * std::fabs(direction_z) * (1 + 0x1p-20f);
  return to_fixed(far, exponent) + 4;
}

// A triangle between these depths certainly has t in (0, t_max); see sure_depths() in leaf_ray.h.
struct FixedDepths {
  std::int32_t low, high;
};
inline FixedDepths fixed_sure_depths(float t_max, float direction_z, int exponent) {
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = 0x1p-80f;
  float size = std::fabs(direction_z), far = (t_max < kMax ? t_max : kMax) * size * (1 - 0x1p-20f);
  return {to_fixed((size + 1) * kTiny, exponent) + 3, far >= kTiny ? to_fixed(far, exponent) - 2 : 0};
}

// Greatest biased exponent of three coordinates.
inline int greatest_exponent(const Vec3& a) {
  std::uint32_t x = magnitude_bits(a.x), y = magnitude_bits(a.y), z = magnitude_bits(a.z);
  std::uint32_t most = x > y ? x : y;
  return static_cast<int>((most > z ? most : z) >> 23);
}

// axis_class() in integers.
inline int fixed_class(const Vec3& direction) {
  std::uint32_t x = magnitude_bits(direction.x), y = magnitude_bits(direction.y), z = magnitude_bits(direction.z);
  std::uint32_t most = x > y ? x : y;
  if (z > most) most = z;
  if (most == 0 || most >= kInfinityBits) return -1;
  int kz = z == most ? 2 : y == most ? 1 : 0;
  return 2 * kz + static_cast<int>(float_bits(direction[kz]) >> 31);
}
constexpr const Axes* kAxesOfClass[6] = {&kAxesX, &kAxesX, &kAxesY, &kAxesY, &kAxesZ, &kAxesZ};
inline FixedFrame fixed_frame(int of_class, int exponent) {
  return {exponent, kAxesOfClass[of_class], -(of_class & 1)};
}

inline FixedRay fixed_ray(const ExactRay& exact, const FixedFrame& frame) {
  FixedRay r;
  r.x = to_fixed(exact.origin[0], frame.exponent), r.y = to_fixed(exact.origin[1], frame.exponent);
  r.z = flipped(frame, to_fixed(exact.origin[2], frame.exponent));
  r.shear_x = (to_fraction(exact.shear[0]) ^ frame.flip) - frame.flip;
  r.shear_y = (to_fraction(exact.shear[1]) ^ frame.flip) - frame.flip;
  r.size_x = r.shear_x < 0 ? -r.shear_x : r.shear_x, r.size_y = r.shear_y < 0 ? -r.shear_y : r.shear_y;
  return r;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
