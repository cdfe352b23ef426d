// Spot checks: the probability of finding wrong pixels, and whether pixels are drawn as it assumes.
#include "split/spot_check.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "support/effort.h"

using namespace pocketray;

namespace {

// The share of all sets of `count` out of `n` pixels that contain one of the first `wrong`.
double enumerated(std::uint32_t n, std::uint32_t wrong, std::uint32_t count) {
  std::uint64_t sets = 0, caught = 0;
  for (std::uint32_t set = 0; set < 1u << n; ++set) {
    if (__builtin_popcount(set) != static_cast<int>(count)) continue;
    ++sets;
    caught += (set & ((1u << wrong) - 1)) != 0;
  }
  return static_cast<double>(caught) / static_cast<double>(sets);
}

}  // namespace

// Goal: the closed form is exact. Method: every set of pixels of a small picture, for every number of wrong and of
// checked ones.
TEST_CASE("spot_check_odds_equal_an_enumeration") {
  for (std::uint32_t rows : {3u, 4u})
    for (std::uint32_t width : {1u, 3u, 4u})
      for (std::uint32_t wrong_rows = 0; wrong_rows <= rows; ++wrong_rows)
        for (double share : {1.0, 0.5, 1e-9}) {
          std::uint32_t n = rows * width, wrong = 0;
          if (wrong_rows > 0) wrong = std::max(1u, static_cast<std::uint32_t>(wrong_rows * width * share + 0.5));
          if (n > 12 && kEffortDivisor > 1) continue;
          for (std::uint32_t pixels = 0; pixels <= n; ++pixels) {
            CAPTURE(rows);
            CAPTURE(width);
            CAPTURE(wrong);
            CAPTURE(pixels);
            CHECK(catch_probability({rows, width, wrong_rows, share, pixels}) ==
                  doctest::Approx(enumerated(n, wrong, pixels)).epsilon(1e-12));
          }
        }
}

// Goal: draws catch wrong pixels with the stated probability, also over several frames. Method: Monte Carlo with a
// seed; five standard deviations.
TEST_CASE("spot_check_odds_equal_a_simulation") {
  struct Row {
    SpotCheck check;
    std::uint32_t frames;
  };
  const Row rows[] = {{{216, 32, 1, 1, 8}, 1}, {{216, 32, 1, 1, 8}, 10},   {{20, 16, 3, 0.5, 5}, 1},
                      {{20, 16, 1, 0, 40}, 4}, {{200, 8, 100, 0.1, 1}, 6}, {{9, 9, 9, 1, 1}, 1}};
  Rng random = make_rng(11);
  for (const Row& row : rows) {
    const SpotCheck& c = row.check;
    double expected = catch_probability(c, row.frames);
    std::uint32_t wrong = std::max(1u, static_cast<std::uint32_t>(c.wrong_rows * c.width * c.wrong_share + 0.5));
    int rounds = effort(20000), caught = 0;
    for (int i = 0; i < rounds; ++i) {
      bool any = false;
      for (std::uint32_t f = 0; f < row.frames; ++f) {
        std::uint32_t picks[64];
        draw_distinct(&random, c.rows * c.width, c.pixels, picks);
        // The wrong ones are spread out, as an adversary might arrange.
        for (std::uint32_t k = 0; k < c.pixels; ++k) any = any || picks[k] % (c.rows * c.width / wrong) == 0;
      }
      caught += any;
    }
    // If the number of wrong ones does not divide the pixels, there are a few more of them.
    double sigma = std::sqrt(rounds * expected * (1 - expected)) + 1;
    CAPTURE(expected);
    CHECK(std::fabs(caught - rounds * expected) <= 5 * sigma);
  }
}

// Goal: tiny probabilities add up instead of being rounded away, and certainty stays certain. Method: closed forms.
TEST_CASE("spot_check_odds_at_the_ends") {
  SpotCheck one_pixel = {8192, 8192, 1, 0, 1};
  double p = 1.0 / (8192.0 * 8192.0);
  CHECK(catch_probability(one_pixel) == doctest::Approx(p).epsilon(1e-12));
  CHECK(catch_probability(one_pixel, 1000) == doctest::Approx(1 - std::pow(1 - p, 1000)).epsilon(1e-6));
  CHECK(catch_probability({240, 320, 240, 1, 1}) == 1);
  CHECK(catch_probability({240, 320, 240, 1, 0}) == 0);
  CHECK(catch_probability({240, 320, 0, 1, 50}) == 0);
  CHECK(catch_probability({0, 320, 1, 1, 50}) == 0);
  CHECK(catch_probability({1, 4, 1, 0.25, 4}) == 1);
  CHECK(catch_probability({1, 4, 9, 9, 1}) == 1);
  CHECK(catch_probability({240, 320, 1, 1, 8}, 0) == 0);
}

// The table of src/remote/README.md.
TEST_CASE("spot_check_table") {
  std::printf("rows wrong of 216, 320 pixels each, %% caught\n%28s", "");
  for (const char* head : {"1 frame", "30", "300"}) std::printf("%10s", head);
  std::printf("\n");
  for (std::uint32_t pixels : {1u, 8u, 40u})
    for (double rows : {216.0, 22.0, 1.0, 0.0}) {
      SpotCheck c = {216, 320, rows > 0 ? static_cast<std::uint32_t>(rows) : 1, rows > 0 ? 1.0 : 0.0, pixels};
      std::printf("%2u pixels a frame, %9s", pixels, rows > 0 ? std::to_string(c.wrong_rows).c_str() : "one pixel");
      double before = 0;
      for (std::uint32_t frames : {1u, 30u, 300u}) {
        double p = catch_probability(c, frames);
        std::printf("%10.4g", 100 * p);
        CHECK(p >= before);
        CHECK(p <= 1);
        before = p;
      }
      std::printf("\n");
    }
}

// Goal: all pixels are equally likely, and all numbers below n. Method: chi² with a seed.
TEST_CASE("spot_check_draws_are_even") {
  Rng random = make_rng(5);
  constexpr std::uint32_t kPixels = 50, kCount = 7;
  std::vector<double> seen(kPixels, 0);
  int rounds = effort(40000);
  for (int i = 0; i < rounds; ++i) {
    std::uint32_t picks[kCount];
    draw_distinct(&random, kPixels, kCount, picks);
    std::set<std::uint32_t> distinct(picks, picks + kCount);
    CHECK(distinct.size() == kCount);
    for (std::uint32_t pick : picks) {
      REQUIRE(pick < kPixels);
      ++seen[pick];
    }
  }
  double expected = static_cast<double>(rounds) * kCount / kPixels, chi = 0;
  for (double count : seen) chi += (count - expected) * (count - expected) / expected;
  CHECK(chi < 100);  // 49 degrees of freedom, fewer by distinctness: 1e-5 at 100
  std::uint32_t all[kPixels];
  draw_distinct(&random, kPixels, kPixels, all);
  CHECK(std::set<std::uint32_t>(all, all + kPixels).size() == kPixels);
  for (std::uint32_t n : {1u, 2u, 3u, 0x80000001u, 0xffffffffu})
    for (int i = 0; i < 100; ++i) CHECK(random_below(&random, n) < n);
}

// Goal: no sender is left out if there are enough checks, and none is safe if there are not. Method: counts over many
// draws.
TEST_CASE("spot_check_allots_to_every_sender") {
  Rng random = make_rng(3);
  const std::uint32_t pixels[4] = {1000, 0, 3, 3000};
  std::uint32_t counts[4], sums[4] = {};
  for (std::uint32_t count : {3u, 4u, 40u, 500u})
    for (int i = 0; i < 200; ++i) {
      allot_checks(&random, count, pixels, 4, counts);
      CHECK(counts[0] >= 1);
      CHECK(counts[1] == 0);
      CHECK(counts[2] >= 1);
      CHECK(counts[2] <= 3);
      CHECK(counts[3] >= 1);
      CHECK(counts[0] + counts[2] + counts[3] <= count);
      if (count < 500) CHECK(counts[0] + counts[2] + counts[3] + 2 >= count);
    }
  for (int i = 0; i < 3000; ++i) {
    allot_checks(&random, 1, pixels, 4, counts);
    CHECK(counts[0] + counts[1] + counts[2] + counts[3] == 1);
    for (int k = 0; k < 4; ++k) sums[k] += counts[k];
  }
  CHECK(sums[1] == 0);
  for (int k : {0, 2, 3}) CHECK(std::abs(static_cast<int>(sums[k]) - 1000) < 150);
  const std::uint32_t nobody[2] = {0, 0};
  allot_checks(&random, 9, nobody, 2, counts);
  CHECK(counts[0] + counts[1] == 0);
}

// Goal: never more than one check beyond those paid for, all of them in the long run, and no frame is safe, however
// little a frame pays. Method: frames that pay for fractions, for many, for too many, for nothing.
TEST_CASE("spot_check_schedule_spends_what_was_paid") {
  for (double paid : {0.013, 0.25, 0.999, 1.0, 3.7, 200.0}) {
    Rng random = make_rng(17);
    CheckSchedule schedule = make_check_schedule(&random);
    double sum = 0, phase[4] = {};
    std::uint64_t count = 0;
    int frames = effort(40000);
    for (int f = 0; f < frames; ++f) {
      sum += paid;
      std::uint32_t due = due_checks(&schedule, paid, &random);
      count += due;
      phase[f % 4] += due;
      if (static_cast<double>(count) > sum + 1 + 1e-6) FAIL("spent more than was paid");
    }
    CAPTURE(paid);
    CHECK(static_cast<double>(count) >= sum - 1 - 1e-6);
    for (double checks : phase) CHECK(std::fabs(checks - sum / 4) <= 5 * std::sqrt(sum / 4) + 1);
  }
  Rng random = make_rng(1);
  CheckSchedule schedule = make_check_schedule(&random);
  for (double nothing : {0.0, -5.0, std::nan("")}) CHECK(due_checks(&schedule, nothing, &random) == 0);
  for (int i = 0; i < 3; ++i) CHECK(due_checks(&schedule, HUGE_VAL, &random) == kSpotChecksMax);
  CHECK(due_checks(&schedule, 0.5, &random) <= 1);
}
