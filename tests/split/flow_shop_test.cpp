// The judge of orders is itself right.
#include "split/flow_shop.h"

#include <doctest/doctest.h>

#include "base/rng.h"
#include "support/effort.h"

using namespace pocketray;

// Goal: the simulation counts what it should. Method: an example by hand. Tracing 4, 1, 3 and sending 2, 5, 1: the
// first is traced at 4 and has come at 6, the second is traced at 5 and comes at 11, the third at 8 and at 12.
TEST_CASE("flow_shop_of_three_jobs_by_hand") {
  const std::vector<ShopJob> jobs = {{0, 1, 4, 2}, {1, 2, 1, 5}, {2, 3, 3, 1}};
  CHECK(shop_ns(jobs, 0) == 12);
  CHECK(shop_ns(jobs, 100) == 112);
  CHECK(shop_ns({}, 7) == 7);
  CHECK(least_shop_ns(jobs, 0) == 9);  // 1 + 5 + 2 + 1
}

// Goal: no order ends before the sorted one. Method: all orders of up to seven jobs, with equal and zero times among
// them.
TEST_CASE("flow_shop_sorted_order_is_the_best_of_all") {
  Rng rng = make_rng(31);
  for (int round = 0; round < effort(300); ++round) {
    std::vector<ShopJob> jobs;
    for (std::uint32_t i = 0, count = 1 + next_u32(&rng) % 7; i < count; ++i)
      jobs.push_back({i, i + 1, double(next_u32(&rng) % 9), double(next_u32(&rng) % 9)});
    const double least = least_shop_ns(jobs, 3);
    sort_jobs(&jobs);
    CHECK(shop_ns(jobs, 3) == least);
  }
}
