// Kernels for AVX2.
#define POCKETRAY_ISA avx2
#include "accel/bvh_kernels.h"

#include "accel/bvh_packet_entry.h"
#include "accel/bvh_shaft.h"
#include "accel/bvh_single.h"

#if defined(__x86_64__)
namespace pocketray {

const BvhKernels kAvx2Kernels = {avx2::closest, avx2::closest_packet<8>, avx2::occluded, avx2::occluded_packet<8>};

}  // namespace pocketray
#endif
