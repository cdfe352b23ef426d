// Kernels for NEON of 32-bit ARM. Rays that it would trace inexactly are left to the baseline.
#include "base/isa.h"

#if defined(POCKETRAY_HAVE_NEON32)
#undef POCKETRAY_ISA
#define POCKETRAY_ISA neon
#define POCKETRAY_NEON32
#include "accel/bvh_kernels_of.h"
#include "accel/denormals.h"

namespace pocketray {
namespace {

template <class Tree, const AccelTraversal& kExact>
struct Guarded {
  static constexpr AccelTraversal kFast = neon::kernels_of<Tree, 4>();
  static void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush(accel, ray) ? kFast : kExact;
    kernels.closest(accel, ray, filter, hit, stats);
  }
  static void closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                             TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush(accel, rays) ? kFast : kExact;
    kernels.closest_packet(accel, rays, filter, hits, stats);
  }
  static bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush(accel, ray) ? kFast : kExact;
    return kernels.occluded(accel, ray, filter, stats);
  }
  static std::uint64_t occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                       TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush(accel, rays) ? kFast : kExact;
    return kernels.occluded_packet(accel, rays, filter, stats);
  }
  static constexpr AccelTraversal traversal() { return {closest, closest_packet, occluded, occluded_packet}; }
};

}  // namespace

const AccelTraversal kNeonKernels = Guarded<neon::BlockTree, kBaselineKernels>::traversal();
const AccelTraversal kNeonCompactKernels = Guarded<neon::CompactTree, kBaselineCompactKernels>::traversal();

}  // namespace pocketray
#endif
