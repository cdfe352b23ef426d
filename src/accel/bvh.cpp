#include "accel/bvh.h"

#include "accel/accel_list.h"
#include "accel/bvh_kernels.h"
#include "base/isa.h"

namespace pocketray {
namespace {

const BvhKernels& kernels() {
#if defined(__x86_64__)
  static constexpr const BvhKernels* kTable[kIsaCount] = {&kBaselineKernels, &kAvx2Kernels, &kAvx512Kernels};
  return *kTable[static_cast<int>(active_isa())];
#else
  return kBaselineKernels;
#endif
}

}  // namespace

void bvh_closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  kernels().closest(accel, ray, filter, hit, stats);
}
void bvh_closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                        TraceStats* stats) {
  kernels().closest_packet(accel, rays, filter, hits, stats);
}
bool bvh_occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  return kernels().occluded(accel, ray, filter, stats);
}
std::uint64_t bvh_occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                  TraceStats* stats) {
  return kernels().occluded_packet(accel, rays, filter, stats);
}

const AccelInfo kBvhAccel = {
    "bvh",
    bvh_need,
    bvh_scratch_need,
    bvh_build,
    bvh_refit,
    bvh_adopt,
    bvh_closest,
    bvh_closest_packet,
    bvh_occluded,
    bvh_occluded_packet,
    bvh_nearest_distance,
};

}  // namespace pocketray
