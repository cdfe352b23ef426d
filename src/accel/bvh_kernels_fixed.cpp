// Kernels for CPUs without floating point.
#include "accel/bvh_fixed.h"
#include "accel/bvh_kernels.h"

namespace pocketray {

const AccelTraversal kFixedKernels = baseline::fixed_kernels_of<baseline::BlockTree>();
const AccelTraversal kFixedCompactKernels = baseline::fixed_kernels_of<baseline::CompactTree>();

}  // namespace pocketray
