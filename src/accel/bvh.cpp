// The two hierarchies of the list: `bvh`, the default, and `compact`, whose leaves hold no vertices, for scenes that
// fill the memory.
#include "accel/bvh.h"

#include "accel/accel_list.h"
#include "accel/bvh_kernels.h"
#include "base/isa.h"
#include "base/soft_float.h"

namespace pocketray {
namespace {

#if defined(__x86_64__)
constexpr const AccelTraversal* kBlockKernels[kIsaCount] = {&kBaselineKernels, &kAvx2Kernels, &kAvx512Kernels};
constexpr const AccelTraversal* kCompactKernels[kIsaCount] = {&kBaselineCompactKernels, &kAvx2CompactKernels,
                                                              &kAvx512CompactKernels};
#elif defined(POCKETRAY_HAVE_NEON32)
constexpr const AccelTraversal* kBlockKernels[kIsaCount] = {&kBaselineKernels, &kNeonKernels};
constexpr const AccelTraversal* kCompactKernels[kIsaCount] = {&kBaselineCompactKernels, &kNeonCompactKernels};
#elif defined(POCKETRAY_HAS_NO_FPU)
constexpr const AccelTraversal* kBlockKernels[kIsaCount] = {&kFixedKernels};
constexpr const AccelTraversal* kCompactKernels[kIsaCount] = {&kFixedCompactKernels};
#else
constexpr const AccelTraversal* kBlockKernels[kIsaCount] = {&kBaselineKernels};
constexpr const AccelTraversal* kCompactKernels[kIsaCount] = {&kBaselineCompactKernels};
#endif

// The functions of AccelInfo for one kind of leaves, with the kernels of every instruction set.
template <const LeafKind& kLeaves, const auto& kKernels>
struct Hierarchy {
  static const AccelTraversal& kernels() { return *kKernels[static_cast<int>(active_isa())]; }
  static std::size_t need(std::uint32_t triangle_count) { return bvh_need(kLeaves, triangle_count); }
  static void build(Accel* accel, Arena* keep, Arena* scratch) { bvh_build(kLeaves, accel, keep, scratch); }
  static void settle(Accel* accel, Array<std::uint8_t> data, Array<const MovingMesh> moving) {
    bvh_settle(kLeaves, accel, data, moving);
  }
  static void refit(Accel* accel, Array<std::uint8_t> data) { bvh_refit(kLeaves, accel, data); }
  static Status adopt(Accel* accel, Array<const std::uint8_t> data, const ParallelLoop& loop) {
    return bvh_adopt(kLeaves, accel, data, loop);
  }
  static void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
    kernels().closest(accel, ray, filter, hit, stats);
  }
  static void closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                             TraceStats* stats) {
    kernels().closest_packet(accel, rays, filter, hits, stats);
  }
  static bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
    return kernels().occluded(accel, ray, filter, stats);
  }
  static std::uint64_t occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                       TraceStats* stats) {
    return kernels().occluded_packet(accel, rays, filter, stats);
  }
  static float largest(const Accel& accel, const TriangleQuery& query) { return bvh_largest(kLeaves, accel, query); }
  static constexpr AccelInfo info(const char* name, const char* help, std::uint32_t magic) {
    return {{closest, closest_packet, occluded, occluded_packet},
            name,
            help,
            true,
            magic,
            need,
            bvh_scratch_need,
            build,
            settle,
            refit,
            adopt,
            largest};
  }
};

}  // namespace

const AccelInfo kBvhAccel = Hierarchy<kBlockLeaves, kBlockKernels>::info("bvh", "", kBvhMagic);
const AccelInfo kCompactAccel = Hierarchy<kCompactLeaves, kCompactKernels>::info(
    "compact", "16 bytes a triangle instead of 52, at 0.75 to 0.95 of the speed", kCompactMagic);

}  // namespace pocketray
