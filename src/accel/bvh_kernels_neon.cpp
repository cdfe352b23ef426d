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

// DenormalGuard for four rays at once.
class DenormalGuard4 {
 public:
  void add_origins(const float (&rows)[3][kPacketMax], std::uint32_t i) {
    for (const float* row : rows) coordinate_ = vminq_u32(coordinate_, less_one(magnitudes(row + i)));
  }
  void add_directions(const float (&rows)[3][kPacketMax], std::uint32_t i) {
    const uint32x4_t a = magnitudes(rows[0] + i), b = magnitudes(rows[1] + i), c = magnitudes(rows[2] + i);
    const uint32x4_t most = vmaxq_u32(vmaxq_u32(a, b), c);
    const uint32x4_t least = vminq_u32(vminq_u32(less_one(a), less_one(b)), less_one(c));
    span_ = vmaxq_u32(span_, vsubq_u32(most, least));
    reach_ = vmaxq_u32(reach_, vsubq_u32(most, vdupq_n_u32(DenormalGuard::kDirectionMin)));
  }
  void add_ends(const float* row) { end_ = vminq_u32(end_, less_one(words(row))); }
  DenormalGuard together() const {
    DenormalGuard g;
    g.coordinate = least(coordinate_), g.end = least(end_), g.span = most(span_), g.reach = most(reach_);
    return g;
  }

 private:
  static uint32x4_t words(const float* p) { return vreinterpretq_u32_f32(vld1q_f32(p)); }
  static uint32x4_t magnitudes(const float* p) { return vshlq_n_u32(words(p), 1); }
  static uint32x4_t less_one(uint32x4_t a) { return vsubq_u32(a, vdupq_n_u32(1)); }
  static std::uint32_t least(uint32x4_t a) {
    uint32x2_t half = vpmin_u32(vget_low_u32(a), vget_high_u32(a));
    return vget_lane_u32(vpmin_u32(half, half), 0);
  }
  static std::uint32_t most(uint32x4_t a) {
    uint32x2_t half = vpmax_u32(vget_low_u32(a), vget_high_u32(a));
    return vget_lane_u32(vpmax_u32(half, half), 0);
  }
  uint32x4_t coordinate_ = vdupq_n_u32(~0u), end_ = coordinate_, span_ = vdupq_n_u32(0), reach_ = span_;
};

template <class Tree, const AccelTraversal& kExact>
struct Guarded {
  static constexpr AccelTraversal kFast = neon::kernels_of<Tree, 4>();
  static void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush(accel, ray) ? kFast : kExact;
    kernels.closest(accel, ray, filter, hit, stats);
  }
  static void closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                             TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush_by_fours(accel, rays) ? kFast : kExact;
    kernels.closest_packet(accel, rays, filter, hits, stats);
  }
  static bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush(accel, ray) ? kFast : kExact;
    return kernels.occluded(accel, ray, filter, stats);
  }
  static std::uint64_t occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                       TraceStats* stats) {
    const AccelTraversal& kernels = is_safe_to_flush_by_fours(accel, rays) ? kFast : kExact;
    return kernels.occluded_packet(accel, rays, filter, stats);
  }
  static constexpr AccelTraversal traversal() { return {closest, closest_packet, occluded, occluded_packet}; }
};

}  // namespace

bool is_safe_to_flush_by_fours(const Accel& accel, const RayPacket& rays) {
  if (!(accel.least_coordinate >= kCoordinateMin)) return false;
  DenormalGuard4 fours;
  std::uint32_t i = 0;
  for (; i + 4 <= rays.count; i += 4) fours.add_directions(rays.direction, i);
  DenormalGuard guard = fours.together();
  guard.add_origin(rays.origin), guard.add_end(rays.t_max);
  add_directions(rays.direction, i, rays.count, &guard);
  return guard.is_safe();
}
bool is_safe_to_flush_by_fours(const Accel& accel, const SegmentPacket& rays) {
  if (!(accel.least_coordinate >= kCoordinateMin)) return false;
  DenormalGuard4 fours;
  std::uint32_t i = 0;
  for (; i + 4 <= rays.count; i += 4)
    fours.add_origins(rays.origin, i), fours.add_directions(rays.direction, i), fours.add_ends(rays.t_max + i);
  DenormalGuard guard = fours.together();
  add_segments(rays, i, &guard);
  return guard.is_safe();
}

const AccelTraversal kNeonKernels = Guarded<neon::BlockTree, kBaselineKernels>::traversal();
const AccelTraversal kNeonCompactKernels = Guarded<neon::CompactTree, kBaselineCompactKernels>::traversal();

}  // namespace pocketray
#endif
