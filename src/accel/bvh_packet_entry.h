// Groups the rays of a packet by dominant axis and traverses the BVH with each group. Part of the kernels: see
// bvh_packet.h.
#pragma once
#include "accel/axis_class.h"
#include "accel/bvh_packet.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Returns whether all 64 directions certainly belong to the class; the other axes must be strictly smaller.
inline bool all_of_class(const RayPacket& rays, int kx, int ky, int kz, float sign) {
  Float4 direction = Float4::splat(sign), max = Float4::splat(std::numeric_limits<float>::max());
  unsigned all = 15;
  for (std::uint32_t i = 0; i < kPacketMax; i += 4) {
    Float4 z = Float4::load(rays.direction[kz] + i) * direction;
    all &= bits((abs(Float4::load(rays.direction[kx] + i)) < z) & (abs(Float4::load(rays.direction[ky] + i)) < z) &
                (z <= max));
  }
  return all == 15;
}

// The rays of one class, when they are not the whole packet.
struct GatheredRays {
  alignas(64) float direction[3][kPacketMax];  // by kx, ky, kz
  std::uint8_t place[kPacketMax];
};
inline int gather_rays(const RayPacket& rays, const std::int8_t* classes, int wanted, const Packet& p,
                       GatheredRays* gathered) {
  int n = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    if (classes[i] != wanted) continue;
    gathered->direction[0][n] = rays.direction[p.kx][i], gathered->direction[1][n] = rays.direction[p.ky][i];
    gathered->direction[2][n] = rays.direction[p.kz][i];
    gathered->place[n++] = static_cast<std::uint8_t>(i);
  }
  return n;
}

template <int kLanes, class Tree>
void closest_of_class(const Tree& bvh, const RayPacket& rays, const std::int8_t* classes, int wanted, Packet* p,
                      Hit* hits, TraceStats* stats) {
  GatheredRays gathered;
  set_axes(p, wanted);
  int count = gather_rays(rays, classes, wanted, *p, &gathered), padded = (count + 15) & ~15;
  for (int i = count; i < padded; ++i)
    for (float* row : gathered.direction) row[i] = row[count - 1];
  p->direction_x = gathered.direction[0], p->direction_y = gathered.direction[1];
  p->direction_z = gathered.direction[2], p->place = gathered.place;
  p->count = padded;
  prepare_packet(p);
  for (int i = count; i < static_cast<int>(kPacketMax); ++i) p->far[i] = -kInfinity;
  search_packet<kLanes>(bvh, p, stats);
  write_hits(*p, count, hits);
}

struct Places {
  std::uint8_t at[kPacketMax];
};
constexpr Places own_places() {
  Places p = {};
  for (std::uint32_t i = 0; i < kPacketMax; ++i) p.at[i] = static_cast<std::uint8_t>(i);
  return p;
}

template <class Tree, int kLanes>
void closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits, TraceStats* stats) {
  static constexpr Places kOwnPlaces = own_places();
  for (std::uint32_t i = 0; i < rays.count; ++i) hits[i].triangle = kNoTriangle;
  if (!(rays.t_max > 0) || rays.count == 0 || is_empty(accel.bounds) || !has_valid_origin(rays.origin)) return;
  Packet packet;
  const Tree bvh(accel);
  packet.origin = rays.origin, packet.t_max = rays.t_max;
  packet.filter = filter && filter->accept ? filter : nullptr;
  int first = axis_class(rays.direction[0][0], rays.direction[1][0], rays.direction[2][0]);
  if (first >= 0 && rays.count == kPacketMax) {
    set_axes(&packet, first);
    if (all_of_class(rays, packet.kx, packet.ky, packet.kz, packet.sign)) {
      packet.direction_x = rays.direction[packet.kx], packet.direction_y = rays.direction[packet.ky];
      packet.direction_z = rays.direction[packet.kz], packet.place = kOwnPlaces.at;
      packet.count = kPacketMax;
      prepare_packet(&packet);
      search_packet<kLanes>(bvh, &packet, stats);
      write_hits(packet, kPacketMax, hits);
      return;
    }
  }
  std::int8_t classes[kPacketMax];
  unsigned met = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    classes[i] = static_cast<std::int8_t>(axis_class(rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]));
    if (classes[i] >= 0) met |= 1u << classes[i];
  }
  for (; met; met &= met - 1) closest_of_class<kLanes>(bvh, rays, classes, __builtin_ctz(met), &packet, hits, stats);
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
