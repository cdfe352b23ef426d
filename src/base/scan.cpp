#include "base/isa.h"

#if defined(POCKETRAY_HAVE_NEON32)
#undef POCKETRAY_ISA
#define POCKETRAY_ISA neon
#define POCKETRAY_NEON32
#endif
#include <initializer_list>

#include "base/check.h"
#include "base/fixed_point.h"
#include "base/float_bits.h"
#include "base/scan.h"
#include "base/simd.h"
#include "base/soft_float.h"
#include "base/words4.h"

namespace pocketray {
namespace {

constexpr std::int32_t kMagnitude = 0x7FFFFFFF;
static_assert(sizeof(Vec3) == 12, "three words");

// Calls step(row, words) for every twelve words, as rows 0 to 2, and then for the rest, completed with copies of the
// words of `fill`. The words of row r, lane i, are those with remainder (r + i) % 3 of their index by 3.
template <class Step>
void for_each_row(const void* words, std::size_t count, Words4 fill, Step step) {
  const std::uint8_t* at = static_cast<const std::uint8_t*>(words);
  for (; count >= 12; count -= 12, at += 48)
    step(0, words_at(at)), step(1, words_at(at + 16)), step(2, words_at(at + 32));
  for (int row = 0; count > 0; ++row, at += 16) {
    CHECK_LT(row, 3);
    Words4 rest = fill;
    const std::size_t here = count < 4 ? count : 4;
    std::memcpy(&rest, at, 4 * here);
    step(row, rest);
    count -= here;
  }
}

std::int32_t highest(const Words4& a) { return ~lowest(~a); }

}  // namespace

std::int32_t largest_word(const void* words, std::size_t count, std::int32_t mask) {
  CHECK(words != nullptr || count == 0);
  CHECK_LE(0, mask);
  Words4 most = all_words(0);
  for_each_row(words, count, most, [&](int, const Words4& row) { most = higher_of(most, row & mask); });
  return highest(most);
}

bool has_word(const void* words, std::size_t count, std::int32_t mask, std::int32_t value) {
  CHECK(words != nullptr || count == 0);
  CHECK_EQ(value & ~mask, 0);
  constexpr std::size_t kStep = 48;
  const std::uint8_t* at = static_cast<const std::uint8_t*>(words);
  for (; count > 0; at += 4 * kStep) {
    const std::size_t here = count < kStep ? count : kStep;
    Words4 found = all_words(0);
    for_each_row(at, here, all_words(~value), [&](int, const Words4& row) { found |= (row & mask) == value; });
    if (any_bit(found)) return true;
    count -= here;
  }
  return false;
}

LargestOfThree largest_of_three(const void* words, std::size_t triple_count, int shift) {
  CHECK(words != nullptr || triple_count == 0);
  CHECK_LE(1, shift);
  const std::int32_t mask = kMagnitude >> (shift - 1);
  Words4 most[3] = {all_words(0), all_words(0), all_words(0)};
  for_each_row(words, 3 * triple_count, most[0],
               [&](int r, const Words4& row) { most[r] = higher_of(most[r], (row >> shift) & mask); });
  LargestOfThree largest = {{0, 0, 0}};
  for (int r = 0; r < 3; ++r)
    for (int lane = 0; lane < 4; ++lane) {
      std::int32_t& of = largest.of[(r + lane) % 3];
      if (most[r][lane] > of) of = most[r][lane];
    }
  return largest;
}

std::uint32_t find_change(const void* words, std::uint32_t begin, std::uint32_t count, std::uint32_t mask) {
  CHECK_LE(1u, begin);
  const std::uint8_t* bytes = static_cast<const std::uint8_t*>(words);
  const Words4 masks = all_words(static_cast<std::int32_t>(mask));
  std::uint32_t i = begin;
  for (; i < count && count - i >= 16; i += 16) {
    const std::uint8_t* at = bytes + 12 * std::size_t(i);
    Words4 change = all_words(0);
    auto changes = [&](int k) { return words_at(at + k) ^ words_at(at + k - 12); };
    for (int k = 0; k < 192; k += 48) change |= changes(k) | changes(k + 16) | changes(k + 32);
    if (any_bit(change & masks)) break;
  }
  for (; i < count; ++i) {
    std::uint32_t pair[6];
    std::memcpy(pair, bytes + 12 * std::size_t(i - 1), sizeof pair);
    if ((((pair[0] ^ pair[3]) | (pair[1] ^ pair[4]) | (pair[2] ^ pair[5])) & mask) != 0) break;
  }
  return i;
}

float least_magnitude(Array<const Vec3> points) {
  // Less one, 0 becomes the largest magnitude.
  Words4 least = all_words(kMagnitude);
  for_each_row(points.data, 3 * std::size_t(points.count), all_words(0),
               [&](int, const Words4& row) { least = lower_of(least, ((row & kMagnitude) - 1) & kMagnitude); });
  const std::int32_t bits = lowest(least) == kMagnitude ? static_cast<std::int32_t>(kInfinityBits) : lowest(least) + 1;
  float magnitude;
  std::memcpy(&magnitude, &bits, sizeof magnitude);
  return magnitude;
}

Box bounds_of(Array<const Vec3> points) {
  Box box = empty_box();
  if (points.empty()) return box;
  // Row r, lane i is along axis (r + i) % 3.
  const Vec3 p = points[0];
  float first[6] = {p.x, p.y, p.z, p.x, p.y, p.z};
  Words4 low[3], high[3];
  for (int r = 0; r < 3; ++r) low[r] = high[r] = sortable(words_at(first + r));
  for_each_row(points.data, 3 * std::size_t(points.count) - 3 * std::size_t(points.count % 4), low[0],
               [&](int r, const Words4& row) {
                 const Words4 sorted = sortable(row);
                 low[r] = lower_of(low[r], sorted), high[r] = higher_of(high[r], sorted);
               });
  for (int r = 0; r < 3; ++r) {
    float lows[4], highs[4];
    const Words4 low_bits = sortable(low[r]), high_bits = sortable(high[r]);  // its own inverse
    std::memcpy(lows, &low_bits, sizeof lows);
    std::memcpy(highs, &high_bits, sizeof highs);
    for (int lane = 0; lane < 4; ++lane) {
      const int axis = (r + lane) % 3;
      if (lows[lane] < box.low[axis]) box.low[axis] = lows[lane];
      if (highs[lane] > box.high[axis]) box.high[axis] = highs[lane];
    }
  }
  for (std::uint32_t i = points.count - points.count % 4; i < points.count; ++i) box = merge(box, points[i]);
  return box;
}

bool is_surely_inside(const Vec3& v, const SquareRange& range) {
  std::uint32_t square = 0, most = 0;
  for (float x : {v.x, v.y, v.z}) {
    const std::uint32_t size = magnitude(to_fraction(x)) >> 16;
    square += size * size, most |= magnitude_bits(x) > float_bits(1);
  }
  return most == 0 && square >= range.low && square <= range.high;
}

SquareRange range_within(float low, float high) {
  constexpr float kOne = 1 << 30;
  CHECK(low >= 0.5f && high <= 1.5f);
  constexpr std::uint32_t kMargin = 1u << 20;  // above 6 · 2^-15 of kOne, by which a square may be too small
  return {static_cast<std::uint32_t>(low * kOne) + kMargin, static_cast<std::uint32_t>(high * kOne) - kMargin};
}

std::uint32_t find_square_outside(Array<const Vec3> vectors, std::uint32_t begin, float low, float high) {
  CHECK_LE(begin, vectors.count);
  std::uint32_t i = begin;
#if defined(POCKETRAY_HAS_NO_FPU)
  const SquareRange range = range_within(low, high);
  for (; vectors.count - i >= 4; i += 4)
    for (std::uint32_t k = i; k < i + 4; ++k)
      if (!is_surely_inside(vectors[k], range)) return i;
#else
  const Float4 lows = Float4::splat(low), highs = Float4::splat(high);
  for (; vectors.count - i >= 4; i += 4) {
    const float* const at[4] = {&vectors[i].x, &vectors[i + 1].x, &vectors[i + 2].x, &vectors[i + 3].x};
    Float4 v[3];
    load_points(at, v);
    const Float4 square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (bits((lows <= square) & (square <= highs)) != 15) break;
  }
#endif
  return i;
}

}  // namespace pocketray
