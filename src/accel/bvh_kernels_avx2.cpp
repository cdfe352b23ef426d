// Kernels for AVX2.
#define POCKETRAY_ISA avx2
#include "accel/bvh_kernels_of.h"

#if defined(__x86_64__)
namespace pocketray {

const AccelTraversal kAvx2Kernels = avx2::kernels_of<avx2::BlockTree, 8>();
const AccelTraversal kAvx2CompactKernels = avx2::kernels_of<avx2::CompactTree, 8>();

}  // namespace pocketray
#endif
