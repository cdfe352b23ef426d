// Where paths branch, as in glass, each sample's tree of rays is kept small while what is left out of it stays bounded.
//
// What a sample may lose grows with the light that it has for certain: display levels of bright pixels are wider. The
// stronger branch comes first, so that this light is known early. A ray is left out if the most that it could add is no
// more than a share of that, and than what is left of it.
#pragma once
#include <algorithm>

#include "shade/frame_data.h"

namespace pocketray {

// Linear radiance of exposed white 1 above which display levels widen, and how fast: with w(L) the width of the level
// at L relative to that at 0, w(L) ≥ 1 + kLevelSlope · (L − kDarkLevels) up to 1. Derived: beyond its linear part,
// sRGB's width 2.4 / 1.055 · L^(1.4 / 2.4) is concave, hence above its chord from there to w(1) = 29.39.
constexpr float kDarkLevels = 0.0031309f;
constexpr float kLevelSlope = 28.4f;

// The share of what a sample may lose that one ray may take: in deep trees of rays, what many strong ones take would be
// missing for the faint ones, which multiply. Measured for five hollow spheres: the fewest rays at depths of 8 to 16.
inline float skip_share(std::uint32_t ray_depth) {
  const std::uint32_t beyond = ray_depth > 8 ? std::min(ray_depth - 8, 6u) : 0;
  return 1 / static_cast<float>(1u << 2 * beyond);
}

// Begins the tracing of a sample that may lose Tracer::budget if it is dark; 0: nothing, however bright it is.
inline void begin_branching(Tracer* tracer) {
  const FrameData& frame = *tracer->frame;
  Branching& b = tracer->branching;
  b.allowed = tracer->budget;
  b.certain = -frame.dark_radiance;
  b.share = frame.left_out_slope > 0 ? skip_share(frame.settings.ray_depth) : 1;
  b.ended = 0;
  b.slope = b.allowed > 0 ? frame.left_out_slope : 0;
  tracer->skip_max = b.share * b.allowed;
}

// Light that the sample has for certain.
inline void add_certain(Tracer* tracer, const Vec3& light) {
  Branching& b = tracer->branching;
  const float darkest = std::min(light.x, std::min(light.y, light.z));
  if (!(darkest > 0 && b.slope > 0)) return;
  const float before = std::max(b.certain, 0.0f);
  b.certain += darkest;
  if (!(b.certain > 0)) return;
  const float more = b.slope * (b.certain - before);
  b.allowed += more;
  tracer->budget += more;
  tracer->skip_max = std::min(b.share * b.allowed, tracer->budget);
}

}  // namespace pocketray
