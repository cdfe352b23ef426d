// Queries of accelerators without a hierarchy.
#pragma once
#include "accel/accel.h"
#include "accel/triangle.h"

namespace pocketray {

// AccelInfo::largest() by querying every triangle.
inline float largest_of_all(const Accel& accel, const TriangleQuery& query) {
  float most = 0;
  for (std::uint32_t i = 0; i < accel.triangles.count; ++i) {
    if (!is_hittable(accel.positions, accel.triangles[i])) continue;
    const float value = query.triangle_value(query.context, i);
    if (value > most) most = value;
  }
  return most;
}

}  // namespace pocketray
