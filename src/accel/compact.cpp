// The accelerator for scenes that fill the memory: the same nodes, leaves without vertices.
#include "accel/bvh.h"

#include "accel/accel_list.h"
#include "accel/bvh_kernels.h"
#include "base/isa.h"

namespace pocketray {
namespace {

const BvhKernels& kernels() {
#if defined(__x86_64__)
  static constexpr const BvhKernels* kTable[kIsaCount] = {&kBaselineCompactKernels, &kAvx2CompactKernels,
                                                          &kAvx512CompactKernels};
  return *kTable[static_cast<int>(active_isa())];
#else
  return kBaselineCompactKernels;
#endif
}

std::size_t need(std::uint32_t triangle_count) { return bvh_need(kCompactLeaves, triangle_count); }
void build(Accel* accel, Arena* keep, Arena* scratch) { bvh_build(kCompactLeaves, accel, keep, scratch); }
void refit(Accel* accel, Array<std::uint8_t> data) { bvh_refit(kCompactLeaves, accel, data); }
Status adopt(Accel* accel, Array<const std::uint8_t> data) { return bvh_adopt(kCompactLeaves, accel, data); }
float nearest_distance(const Accel& accel, const Vec3& point) {
  return bvh_nearest_distance(kCompactLeaves, accel, point);
}
void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  kernels().closest(accel, ray, filter, hit, stats);
}
void closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits, TraceStats* stats) {
  kernels().closest_packet(accel, rays, filter, hits, stats);
}
bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  return kernels().occluded(accel, ray, filter, stats);
}
std::uint64_t occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                              TraceStats* stats) {
  return kernels().occluded_packet(accel, rays, filter, stats);
}

}  // namespace

const AccelInfo kCompactAccel = {
    "compact", kCompactMagic, need,           bvh_scratch_need, build,           refit,
    adopt,     closest,       closest_packet, occluded,         occluded_packet, nearest_distance,
};

}  // namespace pocketray
