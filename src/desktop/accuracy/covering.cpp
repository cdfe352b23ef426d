#include "desktop/accuracy/covering.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr int kOpen = -1;

struct Pair {
  std::size_t knob[2];
  int level[2];
};

struct Search {
  const std::vector<std::vector<double>>& prices;
  double limit;
  std::vector<Pair> open;  // not yet covered

  // Price of the cheapest row that agrees with this one.
  double price(const std::vector<int>& row) const {
    double product = 1;
    for (std::size_t k = 0; k < row.size(); ++k)
      product *= row[k] == kOpen ? *std::min_element(prices[k].begin(), prices[k].end())
                                 : prices[k][static_cast<std::size_t>(row[k])];
    return product;
  }
  bool holds(const std::vector<int>& row, const Pair& p) const {
    return row[p.knob[0]] == p.level[0] && row[p.knob[1]] == p.level[1];
  }
  std::size_t gain(const std::vector<int>& row) const {
    return static_cast<std::size_t>(
        std::count_if(open.begin(), open.end(), [&](const Pair& p) { return holds(row, p); }));
  }
  std::vector<int> start(const Pair& p) const {
    std::vector<int> row(prices.size(), kOpen);
    row[p.knob[0]] = p.level[0], row[p.knob[1]] = p.level[1];
    return row;
  }
  // Number of open pairs that contain the level.
  std::size_t demand(std::size_t knob, int level) const {
    return static_cast<std::size_t>(std::count_if(open.begin(), open.end(), [&](const Pair& p) {
      return (p.knob[0] == knob && p.level[0] == level) || (p.knob[1] == knob && p.level[1] == level);
    }));
  }
  // Returns the level that covers most pairs with the levels already set; on ties, the one with most open pairs
  // elsewhere, then the cheapest.
  int best_level(std::vector<int> row, std::size_t knob) const {
    int best = kOpen;
    std::size_t most = 0, most_demand = 0;
    for (int level = 0; level < static_cast<int>(prices[knob].size()); ++level) {
      row[knob] = level;
      if (price(row) > limit) continue;
      std::size_t covers = gain(row), wanted = demand(knob, level);
      bool cheaper =
          best != kOpen && prices[knob][static_cast<std::size_t>(level)] < prices[knob][static_cast<std::size_t>(best)];
      bool better = covers != most ? covers > most : wanted != most_demand ? wanted > most_demand : cheaper;
      if (best == kOpen || better) best = level, most = covers, most_demand = wanted;
    }
    CHECK_GE(best, 0);
    return best;
  }
  // Fills the row knob by knob, from `first` on, wrapping around.
  void complete(std::size_t first, std::vector<int>* row) const {
    for (std::size_t i = 0; i < row->size(); ++i) {
      std::size_t knob = (first + i) % row->size();
      if ((*row)[knob] == kOpen) (*row)[knob] = best_level(*row, knob);
    }
  }
};

}  // namespace

Covering cover_pairs(const std::vector<std::vector<double>>& prices, double limit) {
  CHECK_GE(limit, 1);
  Covering covering;
  Search search{prices, limit, {}};
  for (std::size_t a = 0; a < prices.size(); ++a)
    for (std::size_t b = a + 1; b < prices.size(); ++b)
      for (int i = 0; i < static_cast<int>(prices[a].size()); ++i)
        for (int j = 0; j < static_cast<int>(prices[b].size()); ++j) {
          Pair pair = {{a, b}, {i, j}};
          ++covering.pair_count;
          if (search.price(search.start(pair)) > limit)
            ++covering.too_dear_count;
          else
            search.open.push_back(pair);
        }
  while (!search.open.empty()) {
    std::vector<int> best;
    std::size_t most = 0;
    for (const Pair& pair : search.open)
      for (std::size_t first = 0; first < prices.size(); ++first) {
        std::vector<int> row = search.start(pair);
        search.complete(first, &row);
        std::size_t covers = search.gain(row);
        if (covers > most) best = row, most = covers;
      }
    CHECK_GT(most, 0u);
    CHECK_EQ(best.size(), prices.size());
    covering.rows.push_back(best);
    search.open.erase(
        std::remove_if(search.open.begin(), search.open.end(), [&](const Pair& p) { return search.holds(best, p); }),
        search.open.end());
  }
  return covering;
}

}  // namespace pocketray
