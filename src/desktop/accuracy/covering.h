// Pairwise covering: a few configurations that together contain every pair of values of any two knobs, to show
// interactions that one-at-a-time variation misses.
#pragma once
#include <cstddef>
#include <vector>

namespace pocketray {

struct Covering {
  std::vector<std::vector<int>> rows;  // the level of each knob
  std::size_t pair_count = 0;          // pairs of levels of two knobs
  std::size_t too_dear_count = 0;      // of these, not covered because every row with them exceeds the limit
};

// `prices`: per knob, the price of each level, at least one, all above 0. A row's price is the product of its levels'
// prices, at most `limit`. Greedy: each row is the best found for the pairs not yet covered [Cohen et al. 1997, "The
// AETG System", sec. 4.1]. Deterministic.
Covering cover_pairs(const std::vector<std::vector<double>>& prices, double limit);

}  // namespace pocketray
