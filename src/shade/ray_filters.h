// The filters of a frame's rays; filters.h makes them.
#pragma once
#include "accel/accel.h"

namespace pocketray {

struct RayFilters {
  HitFilter visible;  // for camera and secondary rays; accept is null without cutouts
  decltype(HitFilter::accept) accept_opaque = nullptr, accept_clear = nullptr;  // with a ShadowContext
  bool read_point = false;                                                      // HitFilter::reads_point
  bool every_shadow = false;  // false: only shadow rays to area lights need the filter
};

}  // namespace pocketray
