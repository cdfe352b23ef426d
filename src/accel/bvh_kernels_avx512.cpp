// Kernels for AVX-512 (F, DQ, VL).
#define POCKETRAY_ISA avx512
#include "accel/bvh_kernels_of.h"

#if defined(__x86_64__)
namespace pocketray {

const AccelTraversal kAvx512Kernels = avx512::kernels_of<avx512::BlockTree, 16>();
const AccelTraversal kAvx512CompactKernels = avx512::kernels_of<avx512::CompactTree, 16>();

}  // namespace pocketray
#endif
