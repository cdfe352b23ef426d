#include "desktop/accuracy/claim.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace pocketray {

std::vector<float> block_means(const std::vector<float>& errors, std::uint32_t width, std::uint32_t height) {
  CHECK_EQ(errors.size(), std::size_t{width} * height);
  CHECK_GT(errors.size(), 0u);
  const std::uint32_t columns = std::min(kBlocksPerSide, width), rows = std::min(kBlocksPerSide, height);
  std::vector<double> sums(std::size_t{columns} * rows), counts(sums.size());
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t block = std::size_t{y} * rows / height * columns + std::size_t{x} * columns / width;
      sums[block] += static_cast<double>(errors[std::size_t{y} * width + x]), counts[block] += 1;
    }
  std::vector<float> means;
  for (std::size_t i = 0; i < sums.size(); ++i) means.push_back(static_cast<float>(sums[i] / counts[i]));
  return means;
}

double without_noise(double against_mean, double against_one, double against_other) {
  return std::min(std::max(2 * against_mean - 0.5 * (against_one + against_other), 0.0), against_mean);
}

Difference difference(const Distance& a, const Distance& b) {
  Difference d = {a.flip - b.flip, 0};
  const std::size_t count = a.one.size();
  if (count == 0 || a.other.size() != count || b.one.size() != count || b.other.size() != count) return d;
  double squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double by_one = static_cast<double>(a.one[i]) - static_cast<double>(b.one[i]);
    const double by_other = static_cast<double>(a.other[i]) - static_cast<double>(b.other[i]);
    squares += 0.25 * (by_one - by_other) * (by_one - by_other);
  }
  d.error = std::sqrt(squares) / static_cast<double>(count);
  return d;
}

bool is_claimed(const Difference& difference) { return std::fabs(difference.value) > 2 * difference.error; }

bool is_nearer(const Distance& a, const Distance& b) {
  const Difference gain = difference(a, b);
  return gain.value > kVisibleStep * a.flip && is_claimed(gain);
}

const Distance& distance_to(const Measured& m, Judge judge) { return judge == Judge::truth ? m.truth : m.model; }
const ReferenceFigures& figures_of(const Sweep& sweep, Judge judge) {
  return judge == Judge::truth ? sweep.truth : sweep.model;
}

std::vector<bool> claimed_front(const std::vector<double>& cost, const std::vector<const Distance*>& distance) {
  CHECK_EQ(cost.size(), distance.size());
  std::vector<std::size_t> order(cost.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] < cost[b] || (cost[a] == cost[b] && distance[a]->flip < distance[b]->flip);
  });
  std::vector<bool> front(cost.size());
  const Distance* last = nullptr;
  for (std::size_t i : order) {
    if (last && !is_nearer(*last, *distance[i])) continue;
    front[i] = true, last = distance[i];
  }
  return front;
}

}  // namespace pocketray
