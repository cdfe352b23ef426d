#include "desktop/accuracy/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kConfidence = 0.95;

// Probability of at most `count` heads among n fair coins.
double coins(std::size_t n, std::size_t count) {
  double term = std::pow(0.5, static_cast<double>(n)), sum = term;
  for (std::size_t i = 0; i < count; ++i) {
    term *= static_cast<double>(n - i) / static_cast<double>(i + 1);
    sum += term;
  }
  return sum;
}

// Interpolates from a to b, either of which may be infinite.
double between(double a, double b, double share) {
  if (!std::isfinite(a) || share == 0 || a == b) return a;
  return std::isfinite(b) ? a + (b - a) * share : b;
}

// The best-fitting law with a given exponent, and its misfit: the sum of the squared relative differences of e².
struct LawAt {
  const std::vector<double>&time, &error;
  double resolution;

  double misfit(double exponent) const {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0, sum = 0;
    auto each = [&](auto&& visit) {
      for (std::size_t i = 0; i < time.size(); ++i) {
        double y = error[i] * error[i], weight = 1 / std::pow(y + resolution * resolution, 2);
        visit(weight, std::pow(time[i] / time.back(), 2 * exponent), y);
      }
    };
    each([&](double weight, double x, double y) {
      w += weight, wx += weight * x, wy += weight * y, wxx += weight * x * x, wxy += weight * x * y;
    });
    double determinant = w * wxx - wx * wx, scale = 0, floor = wy / w;
    if (determinant > 0) scale = (w * wxy - wx * wy) / determinant, floor = (wy - scale * wx) / w;
    if (floor < 0) floor = 0, scale = wxy / wxx;
    if (scale < 0) scale = 0, floor = wy / w;
    each([&](double weight, double x, double y) { sum += weight * std::pow(y - floor - scale * x, 2); });
    return sum;
  }
};

}  // namespace

double median(std::vector<double> values) {
  CHECK_GT(values.size(), 0u);
  std::ptrdiff_t half = static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), values.begin() + half, values.end());
  double upper = values[static_cast<std::size_t>(half)];
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(values.begin(), values.begin() + half));
}

Interval median_interval(const std::vector<double>& values) {
  CHECK(!values.empty());
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::size_t n = sorted.size(), k = 0;
  double middle = median(values), wide = 1, narrow = 1;  // coverage of the k-th and the next values from both ends
  while (k + 1 <= n / 2 && (narrow = 1 - 2 * coins(n, k)) >= kConfidence) wide = narrow, ++k;
  if (k == 0) return {middle, sorted.front(), sorted.back()};
  double part = k + 1 <= n / 2 ? (wide - kConfidence) / (wide - narrow) : 0;
  double rest = static_cast<double>(n - k),
         share = rest * part / (static_cast<double>(k) + (rest - static_cast<double>(k)) * part);
  return {middle, between(sorted[k - 1], sorted[k], share), between(sorted[n - k], sorted[n - k - 1], share)};
}

PowerLaw fit_power_law(const std::vector<double>& time, const std::vector<double>& error, double resolution) {
  CHECK_EQ(time.size(), error.size());
  CHECK_GE(time.size(), 4u);
  CHECK_GE(resolution, 0);
  constexpr double kSteepest = -8;
  constexpr int kSteps = 80;
  LawAt law = {time, error, resolution};
  auto exponent_at = [&](int step) { return kSteepest * step * step / (kSteps * kSteps); };
  int best = 1;
  double least = kInfinity;
  for (int step = 1; step <= kSteps; ++step) {
    double misfit = law.misfit(exponent_at(step));
    if (misfit < least) least = misfit, best = step;
  }
  if (best == 1 || best == kSteps)
    return {best == 1 ? 0 : -kInfinity, std::sqrt(least / static_cast<double>(time.size())) / 2};
  double low = exponent_at(best + 1), high = exponent_at(best - 1);
  for (int i = 0; i < 60; ++i) {
    double a = low + (high - low) / 3, b = high - (high - low) / 3;
    bool left = law.misfit(a) < law.misfit(b);
    (left ? high : low) = left ? b : a;
  }
  double exponent = 0.5 * (low + high);
  return {exponent, std::sqrt(law.misfit(exponent) / static_cast<double>(time.size())) / 2};
}

}  // namespace pocketray
