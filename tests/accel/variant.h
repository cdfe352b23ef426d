// The ways to query hits: every accelerator of the list with every instruction set of this CPU, with single rays and
// with packets. Suites loop over them; all must give the same bits.
#pragma once
#include <string>

#include "accel/accel_world.h"
#include "accel/bvh_kernels.h"
#include "base/isa.h"
#include "support/effort.h"

namespace pocketray {

struct Variant {
  const AccelInfo* accel;
  Isa isa;
  bool in_packets;
};
inline std::string name_of(const Variant& variant) {
  return std::string(variant.accel->name) + ", " + isa_name(variant.isa) + (variant.in_packets ? ", in packets" : "");
}

// The hierarchies with the kernels for CPUs without floating point, whatever this CPU is.
inline const AccelInfo* fixed_variant(const AccelInfo* info) {
  auto with = [](const AccelInfo& hierarchy, const AccelTraversal& kernels) {
    AccelInfo fixed = hierarchy;
    static_cast<AccelTraversal&>(fixed) = kernels;
    fixed.name = &hierarchy == &kBvhAccel ? "bvh in integers" : "compact in integers";
    return fixed;
  };
  static const AccelInfo block = with(kBvhAccel, kFixedKernels), compact = with(kCompactAccel, kFixedCompactKernels);
  return info == &kBvhAccel ? &block : &compact;
}

// Whether it is a BVH, which has kernels for every instruction set and for packets.
inline bool is_hierarchy(const AccelInfo* info) { return info == &kBvhAccel || info == &kCompactAccel; }

// All but brute force, the reference for comparisons. Those that trace the rays of a packet one by one, with one code
// for all instruction sets, are one variant.
inline std::vector<Variant> all_variants() {
  std::vector<Variant> list;
  for (const AccelInfo* info : kAccelList) {
    if (info == &kBruteAccel) continue;
    if (!is_hierarchy(info)) {
      list.push_back({info, best_isa(), true});
      continue;
    }
    for (int isa = 0; isa <= static_cast<int>(best_isa()); ++isa)
      for (bool in_packets : {false, true}) list.push_back({info, static_cast<Isa>(isa), in_packets});
    if (kSoftFloats) continue;  // these kernels are in integers already
    for (bool in_packets : {false, true}) list.push_back({fixed_variant(info), best_isa(), in_packets});
  }
  return list;
}

constexpr int kGroupMax = static_cast<int>(kPacketMax);

// Closest hits of up to kGroupMax rays that share an origin and t_max.
inline void answer(const Variant& variant, const World& world, const Ray* rays, int count, const HitFilter* filter,
                   Hit* hits) {
  select_isa(variant.isa);
  if (!variant.in_packets) {
    for (int i = 0; i < count; ++i) hits[i] = closest(world, rays[i], nullptr, filter);
    return;
  }
  RayPacket packet;
  packet.origin = rays[0].origin, packet.t_max = rays[0].t_max, packet.count = static_cast<std::uint32_t>(count);
  for (int i = 0; i < count; ++i) {
    hits[i] = {-1, -1, -1, 0};
    for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = rays[i].direction[axis];
  }
  variant.accel->closest_packet(world.accel, packet, filter, hits, nullptr);
}

// Result of a comparison with brute force.
struct Tally {
  std::uint64_t rays = 0, hits = 0, wrong = 0;
};

// Compares the answers for one ray: closest hit and occlusion.
inline void compare(const Variant& variant, const World& world, const World& oracle, const Ray& ray, Tally* tally) {
  Hit hit, expected = closest(oracle, ray);
  answer(variant, world, &ray, 1, nullptr, &hit);
  bool found = expected.triangle != kNoTriangle;
  ++tally->rays, tally->hits += found;
  tally->wrong += !same_hit(hit, expected) || variant.accel->occluded(world.accel, ray, nullptr, nullptr) != found;
}

}  // namespace pocketray
