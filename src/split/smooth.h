// Smoothed: a quantity measured over frames. Follows drifts, ignores single outliers, and adopts lasting changes at
// once.
#pragma once
#include <cstdint>

namespace pocketray {

struct Smoothed {
  float value = 0;      // 0: unknown
  float run_mean = 0;   // of the latest samples off the value, all on one side of it
  std::int8_t run = 0;  // their number: positive above, negative below
};

inline bool is_known(const Smoothed& s) { return s.value > 0; }
inline double value_or(const Smoothed& s, double unknown) {
  return is_known(s) ? static_cast<double>(s.value) : unknown;
}

// Adds a sample. Invalid samples (NaN, infinite, zero, or negative, as from a stopped or reset clock) change nothing.
// The value stays positive and finite.
void smooth(Smoothed* s, double sample);

// Multiplies the value by a positive factor; any other factor changes nothing.
void scale(Smoothed* s, double factor);

}  // namespace pocketray
