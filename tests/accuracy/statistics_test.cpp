// Statistics of measurements.
#include "desktop/accuracy/statistics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/rng.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// Nearly Gaussian, mean 0, deviation 1.
double noise(Rng* rng) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += next_double(rng);
  return sum;
}

}  // namespace

TEST_CASE("statistics_median_is_the_middle") {
  CHECK(median({3}) == 3);
  CHECK(median({5, 1, 3}) == 3);
  CHECK(median({4, 1, 3, 2}) == 2.5);
  CHECK(median({2, 2, 9, 2}) == 2);
}

// Goal: a 95 % interval covers the true median in 93 to 97 % of cases, for any distribution and six or more values.
// Method: experiments with uniform, skewed and heavy-tailed noise of known median; the range of fewer values has its
// stated coverage.
TEST_CASE("statistics_interval_of_a_median_holds_the_truth") {
  const int experiments = kEffortDivisor > 1 ? 300 : 2000;
  const double slack = kEffortDivisor > 1 ? 0.04 : 0.02;
  for (std::size_t n : {6u, 7u, 9u, 15u, 30u, 100u})
    for (int kind = 0; kind < 3; ++kind) {
      Rng rng = make_rng(4, n);
      int held = 0;
      for (int experiment = 0; experiment < experiments; ++experiment) {
        std::vector<double> values;
        for (std::size_t i = 0; i < n; ++i) {
          double u = next_double(&rng);
          double skewed = -std::log(1 - u) / std::log(2.0), heavy = 1 + std::tan(3.14159265358979 * (u - 0.5));
          values.push_back(kind == 0 ? 1 + noise(&rng) : kind == 1 ? skewed : heavy);
        }
        Interval i = median_interval(values);
        CHECK((i.low <= i.value && i.value <= i.high));
        held += i.low <= 1 && 1 <= i.high;
      }
      CAPTURE(n);
      CAPTURE(kind);
      CHECK(std::fabs(double(held) / experiments - 0.95) < slack);
    }
  Interval few = median_interval({3, 1, 2});
  CHECK((few.low == 1 && few.value == 2 && few.high == 3));
  Interval one = median_interval({5});
  CHECK((one.low == 5 && one.value == 5 && one.high == 5));
  const double infinity = std::numeric_limits<double>::infinity();
  Interval open = median_interval({-infinity, -infinity, -3, -2, -1, -1, 0});
  CHECK((open.low == -infinity && open.value == -2 && open.high <= 0));
}

// Goal: a power law's exponent is found above any floor, exactly without noise, along with the misfit. Method:
// exponents and floors, the last point far from its limit; errors off by known fractions; a last point above the floor.
TEST_CASE("statistics_power_law_is_found") {
  std::vector<double> time = {1, 2, 4, 6, 9, 12, 16}, error(time.size());
  auto errors = [&](double exponent, double floor) {
    for (std::size_t i = 0; i < time.size(); ++i)
      error[i] = std::sqrt(floor * floor + std::pow(3 * std::pow(time[i], exponent), 2));
  };
  for (double exponent : {-0.25, -0.5, -1.0, -2.0})
    for (double floor : {0.0, 0.3, 2.0}) {
      errors(exponent, floor);
      PowerLaw law = fit_power_law(time, error, 0.001);
      CAPTURE(exponent);
      CAPTURE(floor);
      CHECK(std::fabs(law.exponent - exponent) < 1e-4);
      CHECK(law.misfit < 1e-6);
    }
  // Whichever point is off, even the last, it counts as one of seven.
  double least = 1, most = 0;
  for (std::size_t off = 0; off < time.size(); ++off) {
    errors(-0.5, 0);
    error[off] *= 1.02;
    PowerLaw law = fit_power_law(time, error, 0);
    CHECK(std::fabs(law.exponent + 0.5) < 0.06);
    CHECK((law.misfit > 0.001 && law.misfit < 0.02));
    least = std::fmin(least, std::fabs(law.exponent + 0.5)), most = std::fmax(most, std::fabs(law.exponent + 0.5));
  }
  CHECK(most > least);
  // Errors that differ at equal times, or do not fall, give no exponent.
  PowerLaw nothing = fit_power_law({1, 1, 1, 2}, {2, 3, 4, 1}, 0);
  CHECK((nothing.exponent < -1 || nothing.misfit > 0.1));
  CHECK(fit_power_law({1, 2, 3, 4}, {1, 2, 3, 4}, 0).misfit > 0.1);
}
