// Beam: all rays of a tile of pixels to one light, or from the camera, as a box that moves and grows along them.
#pragma once
#include "base/box.h"

namespace pocketray {

// At t ∈ [0, t_max], the rays are within [low + t·low_slope, high + t·high_slope].
struct Beam {
  Vec3 low, high, low_slope, high_slope;
  float t_max;
};

// Beam of rays from a box along directions within a box, up to t_max times their length.
inline Beam beam_along(const Box& from, const Box& directions, float t_max) {
  return {from.low, from.high, directions.low, directions.high, t_max};
}

}  // namespace pocketray
