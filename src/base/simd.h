// Floats and doubles side by side: the same operations on 4, 8 or 16 lanes, as SSE2, AVX2 or AVX-512 on x86-64, NEON on
// ARM, plain scalars elsewhere. Every operation but product_less() and reciprocal() rounds as IEEE prescribes and none
// is fused, so all give the same bits. NEON of 32-bit ARM flushes denormals: only kernels that never meet any, or bear
// it, use it (kFlushesDenormals; accel/denormals.h).
//
// min and max take no NaN, and of 0 and −0 return either. Comparisons give one bit per lane.
// load() and store() take pointers aligned to the size of the vector. repeat() fills the lanes with the same four
// values over and over; spread() fills four lanes with each of lanes/4 values, from a pointer aligned to their size.
//
// Only four floats have the following. load3() takes three floats, aligned or not, and adds 0. lane<i>() copies one
// lane to all, first() returns the first as a float, signs() one bit per sign. later() and sooner() are max and min of
// distances along a ray: a negative result is either of the negative operands. is_later() is > if at least one operand
// is not negative. No operand of these three may be −0 or NaN. word_outside() returns the one word of four (aligned to
// 16) whose lane is not in the mask; there must be exactly one. product_less() is a·b − c, rounded once or twice,
// whichever is faster, and reciprocal() is 1/a within 3u (u = 2^-24): for bounds that are wide enough, not for results.
//
// load_points() loads four points of three floats each into vectors of their x, y and z.
#pragma once
#if defined(__SSE2__)
#include "base/simd_sse2.h"
#elif defined(__aarch64__)
#include "base/simd_neon.h"
#elif defined(POCKETRAY_NEON32)
#include "base/simd_neon32.h"
#else
#include "base/simd_scalar.h"
#endif

#include "base/isa.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Vectors of this many lanes.
template <int kLanes>
struct Lanes;
template <>
struct Lanes<4> {
  using Floats = Float4;
  using Doubles = Double4;
};

#if defined(POCKETRAY_NEON32)
constexpr bool kFlushesDenormals = true;
#else
constexpr bool kFlushesDenormals = false;
inline Float4 reciprocal(Float4 a) { return Float4::splat(1) / a; }
#endif

}  // namespace POCKETRAY_ISA
}  // namespace pocketray

#if defined(__AVX2__)
#include "base/simd_avx2.h"
#endif
#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include "base/simd_avx512.h"
#endif
