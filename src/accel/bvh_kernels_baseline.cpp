// Kernels for every CPU of the build.
#include "accel/bvh_kernels.h"

#include "accel/bvh_packet_entry.h"
#include "accel/bvh_shaft.h"
#include "accel/bvh_single.h"

namespace pocketray {

const BvhKernels kBaselineKernels = {baseline::closest, baseline::closest_packet<4>, baseline::occluded,
                                     baseline::occluded_packet<4>};

}  // namespace pocketray
