#include "desktop/reference/sobol.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "base/rng.h"
#include "desktop/reference/samples.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

double value(std::uint32_t x) { return x * 0x1p-32; }

}  // namespace

// Goal: the sequence is Sobol's. Method: its first points as printed by [Joe & Kuo 2008], in Gray code order.
TEST_CASE("sobol_begins_with_the_published_points") {
  constexpr double kPoints[8][4] = {{0, 0, 0, 0},
                                    {0.5, 0.5, 0.5, 0.5},
                                    {0.75, 0.25, 0.25, 0.25},
                                    {0.25, 0.75, 0.75, 0.75},
                                    {0.375, 0.375, 0.625, 0.875},
                                    {0.875, 0.875, 0.125, 0.375},
                                    {0.625, 0.125, 0.875, 0.625},
                                    {0.125, 0.625, 0.375, 0.125}};
  for (std::uint32_t i = 0; i < 8; ++i)
    for (int d = 0; d < kSobolDimensionCount; ++d) CHECK(value(sobol_point(i ^ i >> 1).x[d]) == kPoints[i][d]);
}

// Goal: scrambling keeps the points even. Method: each of the 2ᵏ elementary intervals of the first two dimensions, of
// every shape, holds one of 2ᵏ points; so does each of 2ᵏ parts of any one dimension. Runs begin at arbitrary multiples
// of 2ᵏ.
TEST_CASE("sobol_is_even_after_scrambling") {
  for (std::uint32_t seed : {1u, 77u, 0xFFFFFFFFu})
    for (std::uint32_t k : {0u, 3u, 6u, 10u}) {
      std::uint32_t count = 1u << k;
      std::vector<SobolPoint> points;
      for (std::uint32_t i = 0; i < count; ++i) points.push_back(scrambled_sobol_point(5 * count + i, seed));
      auto bits = [](std::uint32_t x, std::uint32_t n) { return n == 0 ? 0 : x >> (32 - n); };
      for (std::uint32_t wide = 0; wide <= k; ++wide) {
        std::vector<int> hits(count);
        for (const SobolPoint& p : points) ++hits[bits(p.x[0], wide) << (k - wide) | bits(p.x[1], k - wide)];
        CHECK(hits == std::vector<int>(count, 1));
      }
      for (int d = 0; d < kSobolDimensionCount; ++d) {
        std::vector<int> hits(count);
        for (const SobolPoint& p : points) ++hits[bits(p.x[d], k)];
        CHECK(hits == std::vector<int>(count, 1));
      }
    }
}

// Goal: each point is uniform by itself, and the points of two seeds, like the dimensions of one point, are
// independent: estimates are unbiased and seeds can be compared. Method: chi² over sixteen parts (15 degrees of
// freedom: above 50 once in 80,000) and correlations (five standard errors) over many seeds.
TEST_CASE("sobol_is_uniform_over_seeds") {
  const int count = effort(16000);
  Rng rng = make_rng(9);
  for (std::uint32_t index : {0u, 1u, 13u}) {
    double cells[4][16] = {}, within[4][4] = {}, between[4] = {};
    for (int i = 0; i < count; ++i) {
      std::uint32_t seed = next_u32(&rng);
      SobolPoint p = scrambled_sobol_point(index, seed), next = scrambled_sobol_point(index, seed + 1);
      for (int d = 0; d < 4; ++d) {
        cells[d][p.x[d] >> 28] += 1;
        between[d] += (value(p.x[d]) - 0.5) * (value(next.x[d]) - 0.5) * 12;
        for (int e = 0; e < d; ++e) within[d][e] += (value(p.x[d]) - 0.5) * (value(p.x[e]) - 0.5) * 12;
      }
    }
    for (int d = 0; d < 4; ++d) {
      double chi2 = 0;
      for (double n : cells[d]) chi2 += (n - count / 16.0) * (n - count / 16.0) / (count / 16.0);
      CAPTURE(index);
      CAPTURE(d);
      CHECK(chi2 < 50);
      CHECK(std::fabs(between[d]) < 5 * std::sqrt(count));
      for (int e = 0; e < d; ++e) CHECK(std::fabs(within[d][e]) < 5 * std::sqrt(count));
    }
  }
}

// Goal: a path depends only on seed, pixel and index, and differs for each. Method: independent and even numbers of
// paths begun in order, out of order and by another object.
TEST_CASE("sobol_paths_follow_from_seed_pixel_and_index") {
  auto numbers = [](ReferenceSamples* samples, std::uint32_t index) {
    samples->begin_path(index);
    Pair pixel = samples->pixel();
    return std::vector<double>{samples->next(), samples->next(), pixel.u, samples->choice()};
  };
  ReferenceSamples in_order(1, 7), out_of_order(1, 7), other_seed(2, 7), other_pixel(1, 8);
  std::vector<double> zero = numbers(&in_order, 0), one = numbers(&in_order, 1);
  CHECK(numbers(&out_of_order, 1) == one);
  CHECK(numbers(&out_of_order, 0) == zero);
  std::vector<double> seed = numbers(&other_seed, 1), pixel = numbers(&other_pixel, 1);
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(zero[i] != one[i]);
    CHECK(seed[i] != one[i]);
    CHECK(pixel[i] != one[i]);
  }
}
