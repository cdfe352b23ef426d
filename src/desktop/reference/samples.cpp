#include "desktop/reference/samples.h"

namespace pocketray {

ReferenceSamples::ReferenceSamples(std::uint64_t seed, std::uint64_t pixel)
    : rng_(make_rng(seed, pixel)), even_(true), seed_(seed), pixel_(pixel) {
  for (std::uint32_t& s : group_seed_) s = next_u32(&rng_);
}

void ReferenceSamples::begin_path(std::uint32_t index) {
  index_ = index;
  rng_ = make_rng(seed_ + (index + 1) * 0x9E3779B97F4A7C15u, pixel_);  // independent of other indices
  for (bool& made : made_) made = false;
  lights_ = directions_ = choices_ = 0;
}

double ReferenceSamples::coordinate(int group, int dimension) {
  if (!even_) return next();
  if (!made_[group]) point_[group] = scrambled_sobol_point(index_, group_seed_[group]), made_[group] = true;
  // Uniform in its cell of 2⁻³², so that it stays continuous when rescaled after a choice.
  return (point_[group].x[dimension] + next_u32(&rng_) * 0x1p-32) * 0x1p-32;
}

Pair ReferenceSamples::pair(int group, int dimension) {
  double u = coordinate(group, dimension);
  return {u, coordinate(group, dimension + 1)};
}

Pair ReferenceSamples::independent() {
  double u = next();
  return {u, next()};
}

}  // namespace pocketray
