// Smoothed: a measured quantity over the frames. Follows drifts, ignores a lone outlier, and takes a lasting change
// over at once.
#pragma once
#include <cstdint>

namespace pocketray {

struct Smoothed {
  float value = 0;      // 0: not known yet
  float run_mean = 0;   // of the latest samples that lay off the value, all on one side of it
  std::int8_t run = 0;  // how many: positive above, negative below
};

inline bool is_known(const Smoothed& s) { return s.value > 0; }

// Takes one more sample. What is no measurement (NaN, infinite, zero or negative: a clock that stood still or went
// back) changes nothing. The value stays positive and finite.
void smooth(Smoothed* s, double sample);

// Multiplies what is known by a positive factor; any other factor changes nothing.
void scale(Smoothed* s, double factor);

}  // namespace pocketray
