// Four 32-bit words side by side, in the compiler's own vectors: integers only, so that no CPU flushes denormals.
#pragma once
#include <cstdint>
#include <cstring>

#if defined(__ARM_NEON)
#include <arm_neon.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace pocketray {

using Words4 = std::int32_t __attribute__((vector_size(16)));

inline Words4 words_at(const void* p) {  // aligned to 4
  Words4 words;
  std::memcpy(&words, __builtin_assume_aligned(p, 4), sizeof words);
  return words;
}
inline Words4 all_words(std::int32_t x) { return Words4{x, x, x, x}; }

inline Words4 lower_of(Words4 a, Words4 b) {
#if defined(__ARM_NEON)
  return reinterpret_cast<Words4>(vminq_s32(reinterpret_cast<int32x4_t>(a), reinterpret_cast<int32x4_t>(b)));
#else
  const Words4 is_less = a < b;
  return (a & is_less) | (b & ~is_less);
#endif
}
inline Words4 higher_of(Words4 a, Words4 b) {
#if defined(__ARM_NEON)
  return reinterpret_cast<Words4>(vmaxq_s32(reinterpret_cast<int32x4_t>(a), reinterpret_cast<int32x4_t>(b)));
#else
  const Words4 is_less = a < b;
  return (b & is_less) | (a & ~is_less);
#endif
}

// Words of which only the lowest matters, in the form that costs least to compare later.
#if defined(__ARM_NEON) && !defined(__aarch64__)
using FoldedWords = int32x2_t;
inline FoldedWords fold(Words4 a) {
  const int32x4_t v = reinterpret_cast<int32x4_t>(a);
  return vpmin_s32(vget_low_s32(v), vget_high_s32(v));
}
#else
using FoldedWords = Words4;
inline FoldedWords fold(Words4 a) { return a; }
#endif

// The lowest word of each.
inline Words4 lowest_of_each(const FoldedWords& a, const FoldedWords& b, const FoldedWords& c, const FoldedWords& d) {
#if defined(__aarch64__)
  const auto v = [](Words4 x) { return reinterpret_cast<int32x4_t>(x); };
  return reinterpret_cast<Words4>(vpminq_s32(vpminq_s32(v(a), v(b)), vpminq_s32(v(c), v(d))));
#elif defined(__ARM_NEON)
  return reinterpret_cast<Words4>(vcombine_s32(vpmin_s32(a, b), vpmin_s32(c, d)));
#elif defined(__SSE2__)
  const auto v = [](Words4 x) { return reinterpret_cast<__m128i>(x); };
  const auto lower = [&](Words4 x, Words4 y) {  // of two lanes each: x, y, x, y
    return lower_of(reinterpret_cast<Words4>(_mm_unpacklo_epi32(v(x), v(y))),
                    reinterpret_cast<Words4>(_mm_unpackhi_epi32(v(x), v(y))));
  };
  const Words4 ab = lower(a, b), cd = lower(c, d);
  return lower_of(reinterpret_cast<Words4>(_mm_unpacklo_epi64(v(ab), v(cd))),
                  reinterpret_cast<Words4>(_mm_unpackhi_epi64(v(ab), v(cd))));
#else
  const auto lowest = [](const Words4& x) {
    const std::int32_t low = x[0] < x[1] ? x[0] : x[1], high = x[2] < x[3] ? x[2] : x[3];
    return low < high ? low : high;
  };
  return Words4{lowest(a), lowest(b), lowest(c), lowest(d)};
#endif
}
inline std::int32_t lowest(const Words4& a) {
  const std::int32_t low = a[0] < a[1] ? a[0] : a[1], high = a[2] < a[3] ? a[2] : a[3];
  return low < high ? low : high;
}

inline bool any_bit(const Words4& a) {
  std::uint64_t halves[2];
  std::memcpy(halves, &a, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}

// Floats as words that sort like them, −0 just below 0.
inline Words4 sortable(Words4 a) { return a ^ ((a >> 31) & 0x7FFFFFFF); }

}  // namespace pocketray
