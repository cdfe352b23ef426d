// The traversals of the BVH, compiled once per instruction set (base/isa.h) by bvh_kernels_*.cpp. All return the same
// bits.
#pragma once
#include "accel/accel.h"
#include "base/isa.h"

namespace pocketray {

// For `bvh` and for `compact`.
extern const AccelTraversal kBaselineKernels, kBaselineCompactKernels;
// In integers, for CPUs without floating point.
extern const AccelTraversal kFixedKernels, kFixedCompactKernels;
#if defined(__x86_64__)
extern const AccelTraversal kAvx2Kernels, kAvx2CompactKernels, kAvx512Kernels, kAvx512CompactKernels;
#elif defined(POCKETRAY_HAVE_NEON32)
extern const AccelTraversal kNeonKernels, kNeonCompactKernels;
#endif

}  // namespace pocketray
