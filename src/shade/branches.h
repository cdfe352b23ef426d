// Bounds the tree of rays of a sample whose path branches, as in glass, and the error of pruning it.
//
// The error allowed grows with the light already certain, because display levels of bright pixels are wider. The
// stronger branch is traced first, so that this light is known early. A ray is pruned if its upper bound is at most a
// share of the allowed error and at most what remains of it.
#pragma once
#include <algorithm>

#include "shade/frame_data.h"
#include "shade/tracer.h"

namespace pocketray {

// Display levels widen above kDarkLevels (linear, exposed white is 1), by at least kLevelSlope: with w(L) the width of
// the level at L relative to L = 0, w(L) ≥ 1 + kLevelSlope · (L − kDarkLevels) up to 1. Derived: beyond its linear
// part, sRGB's width 2.4 / 1.055 · L^(1.4 / 2.4) is concave, hence above its chord from there to w(1) = 29.39.
constexpr float kDarkLevels = 0.0031309f;
constexpr float kLevelSlope = 28.4f;

// Share of a sample's allowed error that one ray may use: in deep trees, a few strong rays would otherwise use up what
// the many faint ones need. Measured for five hollow spheres: the fewest rays at depths of 8 to 16.
inline float skip_share(std::uint32_t ray_depth) {
  const std::uint32_t beyond = ray_depth > 8 ? std::min(ray_depth - 8, 6u) : 0;
  return 1 / static_cast<float>(1u << 2 * beyond);
}

// Starts a sample whose allowed error is Tracer::budget if it is dark; with 0, no error is allowed at any brightness.
inline void begin_branching(Tracer* tracer) {
  const FrameData& frame = *tracer->frame;
  Branching& b = tracer->branching;
  b.allowed = tracer->budget;
  b.certain = -frame.cut_off.dark_radiance;
  b.share = frame.cut_off.left_out_slope > 0 ? skip_share(frame.settings.ray_depth) : 1;
  b.ended = 0;
  b.slope = b.allowed > 0 ? frame.cut_off.left_out_slope : 0;
  tracer->skip_max = b.share * b.allowed;
}

// Adds light that is certain to reach the sample.
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
