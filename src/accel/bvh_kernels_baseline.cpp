// Kernels for every CPU of the build.
#include "accel/bvh_kernels_of.h"

namespace pocketray {

const AccelTraversal kBaselineKernels = baseline::kernels_of<baseline::BlockTree, 4>();
const AccelTraversal kBaselineCompactKernels = baseline::kernels_of<baseline::CompactTree, 4>();

}  // namespace pocketray
