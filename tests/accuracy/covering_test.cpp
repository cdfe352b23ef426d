// Covering sets.
#include "desktop/accuracy/covering.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/rng.h"

using namespace pocketray;

namespace {

using Prices = std::vector<std::vector<double>>;

double price_of(const Prices& prices, const std::vector<int>& row) {
  double product = 1;
  for (std::size_t k = 0; k < row.size(); ++k) product *= prices[k][static_cast<std::size_t>(row[k])];
  return product;
}

bool has_pair(const Covering& c, std::size_t a, int i, std::size_t b, int j) {
  return std::any_of(c.rows.begin(), c.rows.end(),
                     [&](const std::vector<int>& row) { return row[a] == i && row[b] == j; });
}

// Checks that every pair is in a row, or counted because the cheapest row with it exceeds the limit.
void check_covering(const Prices& prices, double limit, const Covering& c) {
  std::size_t pairs = 0, too_dear = 0;
  for (const std::vector<int>& row : c.rows) {
    REQUIRE(row.size() == prices.size());
    CHECK(price_of(prices, row) <= limit);
  }
  for (std::size_t a = 0; a < prices.size(); ++a)
    for (std::size_t b = a + 1; b < prices.size(); ++b)
      for (int i = 0; i < static_cast<int>(prices[a].size()); ++i)
        for (int j = 0; j < static_cast<int>(prices[b].size()); ++j) {
          double least = prices[a][static_cast<std::size_t>(i)] * prices[b][static_cast<std::size_t>(j)];
          for (std::size_t k = 0; k < prices.size(); ++k)
            if (k != a && k != b) least *= *std::min_element(prices[k].begin(), prices[k].end());
          ++pairs;
          too_dear += least > limit;
          CHECK(has_pair(c, a, i, b, j) == (least <= limit));
        }
  CHECK(c.pair_count == pairs);
  CHECK(c.too_dear_count == too_dear);
}

}  // namespace

// Goal: all pairs occur in few rows more than the largest two knobs need. Method: nine knobs of three levels (9 rows is
// the minimum for four knobs, 13 the best known for nine); others by count.
TEST_CASE("covering_has_every_pair_in_few_rows") {
  struct Case {
    std::size_t knobs, levels, rows_max;
  };
  for (Case t : {Case{9, 3, 18}, Case{4, 3, 12}, Case{2, 3, 9}, Case{6, 2, 8}, Case{1, 3, 0}, Case{0, 0, 0}}) {
    Prices prices(t.knobs, std::vector<double>(t.levels, 1.0));
    Covering c = cover_pairs(prices, 1);
    CAPTURE(t.knobs);
    check_covering(prices, 1, c);
    CHECK(c.rows.size() <= t.rows_max);
  }
}

// Goal: pairs beyond the limit are skipped and counted, all others are covered. Method: random prices and limits.
TEST_CASE("covering_keeps_to_the_price_limit") {
  Rng rng = make_rng(3);
  std::size_t left_out = 0;
  for (int round = 0; round < 30; ++round) {
    Prices prices;
    std::size_t knobs = 2 + next_u32(&rng) % 5;
    double limit = 1;
    for (std::size_t k = 0; k < knobs; ++k) {
      prices.emplace_back();
      for (std::uint32_t n = 1 + next_u32(&rng) % 3; n > 0; --n) prices.back().push_back(0.1 + 10 * next_double(&rng));
      limit *= *std::min_element(prices.back().begin(), prices.back().end());
    }
    limit *= 1 + 20 * next_double(&rng);
    Covering c = cover_pairs(prices, limit);
    check_covering(prices, limit, c);
    left_out += c.too_dear_count;
    CHECK(cover_pairs(prices, limit).rows == c.rows);  // the same on every call
  }
  CHECK(left_out > 0);
}
