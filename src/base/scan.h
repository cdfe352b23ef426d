// Quick scans of large arrays, a few instructions an element.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/array.h"
#include "base/box.h"

namespace pocketray {

// Largest of some 32-bit words under a mask below 2^31; 0 if there are none. `words` is aligned to 4.
std::int32_t largest_word(const void* words, std::size_t count, std::int32_t mask);

// Returns whether one of some words equals `value` under the mask.
bool has_word(const void* words, std::size_t count, std::int32_t mask, std::int32_t value);

// Largest of the words 0, 3, 6, …, of 1, 4, 7, … and of 2, 5, 8, …, each shifted right by `shift` bits, 1 or more.
struct LargestOfThree {
  std::int32_t of[3];
};
LargestOfThree largest_of_three(const void* words, std::size_t triple_count, int shift);

// Returns the first triple of words from `begin` on that differs from the one before it under the mask; `count` if none
// does. `begin` is 1 or more.
std::uint32_t find_change(const void* words, std::uint32_t begin, std::uint32_t count, std::uint32_t mask);

// Smallest magnitude of a coordinate other than 0; infinity if all are 0. No coordinate may be NaN.
float least_magnitude(Array<const Vec3> points);

// Bounds of all points; no coordinate may be NaN.
Box bounds_of(Array<const Vec3> points);

// Limits of squares in units of 2^-30, and whether a vector has a square well within; for CPUs without floating point.
struct SquareRange {
  std::uint32_t low, high;
};
SquareRange range_within(float low, float high);
bool is_surely_inside(const Vec3& v, const SquareRange& range);

// Returns the first i from `begin` on, in steps of 4, where one of the vectors i to i + 3 may have a square outside
// [low, high], or there are fewer than four of them. NaN is outside. low ≥ 0.5, high ≤ 1.5; without an FPU, only
// vectors without a coordinate beyond 1 and by 2^-10 within these limits are known to be inside.
std::uint32_t find_square_outside(Array<const Vec3> vectors, std::uint32_t begin, float low, float high);

}  // namespace pocketray
