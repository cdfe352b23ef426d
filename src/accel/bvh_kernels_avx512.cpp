// Kernels for AVX-512 (F, DQ, VL).
#define POCKETRAY_ISA avx512
#include "accel/bvh_kernels.h"

#include "accel/bvh_packet_entry.h"
#include "accel/bvh_shaft.h"
#include "accel/bvh_single.h"

#if defined(__x86_64__)
namespace pocketray {

const BvhKernels kAvx512Kernels = {avx512::closest, avx512::closest_packet<16>, avx512::occluded,
                                   avx512::occluded_packet<16>};

}  // namespace pocketray
#endif
