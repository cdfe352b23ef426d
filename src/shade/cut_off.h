// Limits of the light that a frame may leave out because nobody would see it; branches.h.
#pragma once
#include <algorithm>
#include <iterator>

#include "base/limits.h"
#include "base/vec3.h"

namespace pocketray {

// Upper bounds of the radiance along a ray, by the number of reflections and refractions still allowed.
struct RadianceBounds {
  float after[kRayDepthMax + 1] = {};

  bool operator==(const RadianceBounds& other) const { return std::equal(after, std::end(after), other.after); }
  bool operator!=(const RadianceBounds& other) const { return !(*this == other); }
};

struct CutOff {
  RadianceBounds radiance_bounds;
  Vec3 beyond_depth = {0, 0, 0};  // radiance assumed for rays beyond Settings::ray_depth
  float left_out_max = 0;         // error allowed for a dark sample, as radiance
  float left_out_slope = 0;       // growth of left_out_max per radiance of the darkest channel above dark_radiance
  float dark_radiance = 0;        // see branches.h
};

}  // namespace pocketray
