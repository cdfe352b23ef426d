// The traversals of the BVH, compiled once per instruction set (base/isa.h) by bvh_kernels_*.cpp. All return the same
// bits.
#pragma once
#include "accel/accel.h"

namespace pocketray {

// The functions of AccelInfo, for `bvh` and `compact`.
struct BvhKernels {
  void (*closest)(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats);
  void (*closest_packet)(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                         TraceStats* stats);
  bool (*occluded)(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats);
  std::uint64_t (*occluded_packet)(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                   TraceStats* stats);
};

extern const BvhKernels kBaselineKernels, kBaselineCompactKernels;
#if defined(__x86_64__)
extern const BvhKernels kAvx2Kernels, kAvx2CompactKernels, kAvx512Kernels, kAvx512CompactKernels;
#endif

}  // namespace pocketray
