// The random numbers of a path. The most important ones, those of its first scatterings, are coordinates of scrambled
// Sobol points, so that the paths of a pixel are spread evenly; all others are independent. Each number is uniform in
// [0, 1).
#pragma once
#include "base/rng.h"
#include "desktop/reference/sobol.h"

namespace pocketray {

struct Pair {
  double u, v;
};

class ReferenceSamples {
 public:
  // Independent numbers only.
  explicit ReferenceSamples(const Rng& rng) : rng_(rng) {}
  // For one pixel; begin_path() then starts each path, which depends only on seed, pixel and index.
  ReferenceSamples(std::uint64_t seed, std::uint64_t pixel);
  void begin_path(std::uint32_t index);

  double next() { return next_double(&rng_); }
  // For decisions made once per path, or once per scattering.
  Pair pixel() { return pair(0, 0); }
  Pair light() { return ++lights_ == 1 ? pair(0, 2) : lights_ == 2 ? pair(2, 0) : independent(); }
  Pair direction() { return ++directions_ == 1 ? pair(1, 0) : directions_ == 2 ? pair(2, 2) : independent(); }
  double choice() { return ++choices_ == 1 ? coordinate(1, 2) : choices_ == 2 ? coordinate(1, 3) : next(); }
  const Rng& rng() const { return rng_; }

 private:
  static constexpr int kGroupCount = 3;  // of four dimensions each, mutually independent
  double coordinate(int group, int dimension);
  Pair pair(int group, int dimension);
  Pair independent();

  Rng rng_;
  bool even_ = false;
  std::uint64_t seed_ = 0, pixel_ = 0;
  std::uint32_t index_ = 0, group_seed_[kGroupCount] = {};
  bool made_[kGroupCount] = {};
  SobolPoint point_[kGroupCount];
  int lights_ = 0, directions_ = 0, choices_ = 0;
};

}  // namespace pocketray
