// Two-way covering: a few configurations in which every pair of values of every two knobs occurs together, for what
// knobs do to each other that one at a time does not show.
#pragma once
#include <cstddef>
#include <vector>

namespace pocketray {

struct Covering {
  std::vector<std::vector<int>> rows;  // the level of each knob
  std::size_t pair_count = 0;          // pairs of levels of two knobs
  std::size_t too_dear_count = 0;      // of them in no row, since no row with them keeps to the limit
};

// `prices` has for each knob the price of each of its levels, at least one, all above 0; a row's price is the product
// of its levels'. No row is dearer than `limit`. Greedy: each row is the best found for the pairs that are still to be
// covered [Cohen et al. 1997, "The AETG System", sec. 4.1], the same on every call.
Covering cover_pairs(const std::vector<std::vector<double>>& prices, double limit);

}  // namespace pocketray
