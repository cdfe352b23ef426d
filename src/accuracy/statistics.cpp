#include "accuracy/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/rng.h"

namespace pocketray {
namespace {

constexpr int kResamples = 2000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// 97.5th percentile of Student's t for 1 to 10 degrees of freedom; beyond, Cornish and Fisher's expansion to the second
// term [Abramowitz & Stegun 1964, eq. 26.7.5], good to 2e-3 there.
double student_975(std::size_t degrees) {
  constexpr double table[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281};
  CHECK_GT(degrees, 0u);
  if (degrees <= 10) return table[degrees - 1];
  double z = 1.959964, n = static_cast<double>(degrees);
  return z + (z * z * z + z) / (4 * n) + (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * n * n);
}

}  // namespace

double median(std::vector<double> values) {
  CHECK_GT(values.size(), 0u);
  std::ptrdiff_t half = static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), values.begin() + half, values.end());
  double upper = values[static_cast<std::size_t>(half)];
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(values.begin(), values.begin() + half));
}

Interval median_ratio(const std::vector<double>& times, const std::vector<double>& baselines, std::uint64_t seed) {
  CHECK_EQ(times.size(), baselines.size());
  std::vector<double> ratios(times.size());
  for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] = times[i] / baselines[i];
  Rng rng = make_rng(seed);
  std::vector<double> medians(kResamples), drawn(ratios.size());
  for (double& m : medians) {
    for (double& d : drawn)
      d = ratios[static_cast<std::size_t>(next_double(&rng) * static_cast<double>(ratios.size()))];
    m = median(drawn);
  }
  std::sort(medians.begin(), medians.end());
  return {median(ratios), medians[kResamples / 40], medians[kResamples - 1 - kResamples / 40]};
}

Interval slope_to_limit(const std::vector<double>& time, const std::vector<double>& error) {
  CHECK_EQ(time.size(), error.size());
  CHECK_GE(time.size(), 4u);
  constexpr double kSteepest = -8, kFlattest = -1e-3, kStep = 0.01;
  // How badly an exponent fits: the weighted variance of what log c would be at each point, times the weights.
  auto misfit = [&](double s) {
    double weights = 0, mean = 0, sum = 0, last = std::pow(error.back(), 4);
    for (std::size_t i = 0; i + 1 < time.size(); ++i) {
      double own = error[i] * error[i] - error.back() * error.back();
      double law = std::pow(time[i] / time.back(), 2 * s) - 1;  // the scale is left to c
      CHECK(own > 0 && time[i] < time.back());
      double log_c = 0.5 * std::log(own / law), weight = own * own / (std::pow(error[i], 4) + last);
      double step = log_c - mean;  // West's update
      weights += weight;
      mean += step * weight / weights;
      sum += weight * step * (log_c - mean);
    }
    return sum;
  };
  double best = kFlattest;
  for (double s = kSteepest; s < kFlattest; s += kStep)
    if (misfit(s) < misfit(best)) best = s;
  double low = std::max(kSteepest, best - kStep), high = std::min(kFlattest, best + kStep);
  for (int i = 0; i < 60; ++i) {
    double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (misfit(a) < misfit(b) ? high : low) = misfit(a) < misfit(b) ? b : a;
  }
  best = 0.5 * (low + high);
  std::size_t freedom = time.size() - 3;
  double t = student_975(freedom), most = misfit(best) * (1 + t * t / static_cast<double>(freedom));
  auto end = [&](double bound, double beyond) {
    if (misfit(bound) <= most) return beyond;
    double inside = best, outside = bound;
    for (int i = 0; i < 60; ++i) {
      double middle = 0.5 * (inside + outside);
      (misfit(middle) <= most ? inside : outside) = middle;
    }
    return inside;
  };
  return {best, end(kSteepest, -kInfinity), end(kFlattest, 0)};
}

std::vector<bool> pareto_front(const std::vector<double>& cost, const std::vector<double>& error, double resolution) {
  CHECK_EQ(cost.size(), error.size());
  std::vector<std::size_t> order(cost.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] < cost[b] || (cost[a] == cost[b] && error[a] < error[b]);
  });
  std::vector<bool> front(cost.size());
  double least = kInfinity;
  for (std::size_t i : order) {
    front[i] = error[i] < least - resolution;
    if (front[i]) least = error[i];
  }
  return front;
}

}  // namespace pocketray
