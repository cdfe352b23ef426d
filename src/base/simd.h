// Floats and doubles side by side: the same operations on 4 lanes, as SSE2 on x86-64, NEON on aarch64,
// plain scalars elsewhere. Every operation rounds as IEEE says and none is fused, so all give the same bits.
// NEON of 32-bit ARM flushes denormals and is left out for that.
//
// min and max return the second operand where the operands are equal or not ordered. Comparisons give one bit per lane.
// Pointers of load() and store() are aligned to the size of the vector.
#pragma once
#if defined(__SSE2__)
#include "base/simd_sse2.h"
#elif defined(__aarch64__)
#include "base/simd_neon.h"
#else
#include "base/simd_scalar.h"
#endif
