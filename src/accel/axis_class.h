// Classifies rays by dominant axis. Part of the kernels: see bvh_packet.h and bvh_shaft.h.
#pragma once
#include <cmath>
#include <limits>

#include "base/isa.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Dominant axis and sign of a direction as in make_sheared_ray(): 2·axis + (1 if negative). −1: hits nothing.
inline int axis_class(float dx, float dy, float dz) {
  float x = std::fabs(dx), y = std::fabs(dy), z = std::fabs(dz);
  constexpr float max = std::numeric_limits<float>::max();
  if (!(x <= max && y <= max && z <= max) || (x == 0 && y == 0 && z == 0)) return -1;
  int kz = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
  return 2 * kz + ((kz == 0 ? dx : kz == 1 ? dy : dz) < 0);
}

// Sets the axes and the sign of a Packet or a Bundle of that class.
template <class Rays>
void set_axes(Rays* rays, int axis_class) {
  rays->kz = axis_class >> 1, rays->kx = rays->kz == 2 ? 0 : rays->kz + 1, rays->ky = rays->kx == 2 ? 0 : rays->kx + 1;
  rays->sign = axis_class & 1 ? -1.0f : 1.0f;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
