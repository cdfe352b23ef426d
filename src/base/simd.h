// Floats and doubles side by side: the same operations on 4, 8 or 16 lanes, as SSE2, AVX2 or AVX-512 on x86-64, NEON on
// aarch64, plain scalars elsewhere. Every operation but product_less() rounds as IEEE says and none is fused, so all
// give the same bits. NEON of 32-bit ARM flushes denormals and is left out for that.
//
// min and max return the second operand where the operands are equal or not ordered. Comparisons give one bit per lane.
// Pointers of load() and store() are aligned to the size of the vector. repeat() fills the lanes with four values again
// and again, spread() with lanes/4 values four times each; its pointer is aligned to them.
//
// Four floats alone have more. load3() takes three floats, aligned or not, and 0; lane<i>() is one lane in all of them,
// first() the first as a float, signs() a bit per sign. later() and sooner() are max and min of distances along a ray:
// where the result is negative, it is either operand that is. is_later() is > where one of both is not negative. No
// operand of these three may be −0 or NaN. word_outside() is that of four words, aligned to 16, whose lane is not in
// the mask, where there is just one.
// product_less() is a·b − c, rounded once or twice as is fastest: for bounds that are wide enough, never for what
// becomes an answer.
//
// load_points() puts four points, three floats each, into vectors of their x, y and z.
#pragma once
#if defined(__SSE2__)
#include "base/simd_sse2.h"
#elif defined(__aarch64__)
#include "base/simd_neon.h"
#else
#include "base/simd_scalar.h"
#endif

namespace pocketray {
// Vectors of so many lanes.
template <int kLanes>
struct Lanes;
template <>
struct Lanes<4> {
  using Floats = Float4;
  using Doubles = Double4;
};
}  // namespace pocketray

#if defined(__AVX2__)
#include "base/simd_avx2.h"
#endif
#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include "base/simd_avx512.h"
#endif
