// Slopes limited so that light between stored values does not leave their range, in particular below zero.
#pragma once

namespace pocketray {

// Of the values at a place and its neighbours.
struct LightRange {
  float low, high;
};

// The largest share in [0, 1] of `step` that keeps value + share·step in the range.
inline float share_within(const LightRange& range, float value, float step) {
  if (step > range.high - value) return (range.high - value) / step;
  if (step < range.low - value) return (range.low - value) / step;
  return 1;
}

}  // namespace pocketray
