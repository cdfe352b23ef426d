// Traverses the BVH in integers, for CPUs without floating point; floats only resolve what integers leave in doubt and
// locate the hits that count. The answers equal those of the other kernels bit for bit. Like every kernel, compiled
// once per instruction set, in its own namespace.
#pragma once
#include "accel/fixed_bundle.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kFixedBundleMin = 4;  // fewer rays are traced one by one

// Bundles the rays of a packet by class and calls bundle(b) for each bundle and single(i) for the other rays.
template <class Tree, class Rays, class Bundle, class Single>
void bundle_rays(const FixedQuery<Tree>& query, const Rays& rays, Bundle bundle, Single single) {
  std::int8_t classes[kPacketMax];
  int counts[6] = {}, exponent = 0;
  bool in_integers = true;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    int of_class, own_exponent;
    FixedStart start = start_fixed(query, ray_of(rays, i), &of_class, &own_exponent);
    classes[i] = -1;
    if (start == FixedStart::nothing) continue;
    classes[i] = static_cast<std::int8_t>(of_class), ++counts[of_class];
    if (own_exponent > exponent) exponent = own_exponent;
    if (start == FixedStart::in_floats) in_integers = false;
  }
  FixedBundle b;
  for (int of_class = 0; of_class < 6; ++of_class) {
    if (counts[of_class] == 0) continue;
    const bool together = in_integers && counts[of_class] >= kFixedBundleMin;
    b.count = 0, b.frame = fixed_frame(of_class, exponent);
    for (std::uint32_t i = 0; i < rays.count; ++i) {
      if (classes[i] != of_class) continue;
      if (together)
        add_ray(&b, ray_of(rays, i), i);
      else
        single(i);
    }
    if (together) bundle(&b);
  }
}

template <class Tree>
void closest_fixed(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  closest_of_ray(FixedQuery<Tree>(accel, filter, stats), ray, hit);
}

template <class Tree>
void closest_packet_fixed(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                          TraceStats* stats) {
  const FixedQuery<Tree> query(accel, filter, stats);
  for (std::uint32_t i = 0; i < rays.count; ++i) hits[i].triangle = kNoTriangle;
  bundle_rays(
      query, rays, [&](FixedBundle* b) { closest_in_bundle(query, b, hits); },
      [&](std::uint32_t i) { closest_of_ray(query, ray_of(rays, i), &hits[i]); });
}

template <class Tree>
bool occluded_fixed(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  return occluded_ray(FixedQuery<Tree>(accel, filter, stats), ray);
}

template <class Tree>
std::uint64_t occluded_packet_fixed(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                    TraceStats* stats) {
  const FixedQuery<Tree> query(accel, filter, stats);
  std::uint64_t blocked = 0;
  bundle_rays(
      query, rays, [&](FixedBundle* b) { blocked |= occluded_in_bundle(query, b); },
      [&](std::uint32_t i) { blocked |= static_cast<std::uint64_t>(occluded_ray(query, ray_of(rays, i))) << i; });
  return blocked;
}

template <class Tree>
constexpr AccelTraversal fixed_kernels_of() {
  return {closest_fixed<Tree>, closest_packet_fixed<Tree>, occluded_fixed<Tree>, occluded_packet_fixed<Tree>};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
