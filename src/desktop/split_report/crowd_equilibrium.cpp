#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "desktop/split_report/crowd.h"

namespace pocketray {
namespace {

constexpr int kRounds = 150, kBisections = 25;
constexpr double kStep = 0.05;  // towards the prices that the answers imply: chosen, small enough to converge

// Time of the client's best frame if a pixel of its i-th server takes prices[i] times its work; busy[i] receives the
// fraction of that time in which each server has work for it.
double best_frame_ns(const Crowd& crowd, const CrowdClient& c, const double* prices, double* busy) {
  const double pixels = double(crowd.row_pixels) * crowd.row_count, alone = pixels * c.pixel_ns;
  const double start = 2 * static_cast<double>(c.latency_ns), byte_ns = crowd.pixel_bytes * c.ns_per_byte;
  auto pixels_of = [&](std::uint32_t i, double ns) {
    const double pixel_ns = prices[i] * crowd.servers[c.servers[i]].pixel_ns;
    return std::max(0.0, ns - start) / std::max(pixel_ns, byte_ns);
  };
  auto pixels_within = [&](double ns) {
    double sum = 0;
    for (std::uint32_t i = 0; i < c.server_count; ++i) sum += pixels_of(i, ns);
    return ns / c.pixel_ns + std::min(sum, std::max(0.0, ns - start) / byte_ns);
  };
  CHECK_GE(pixels_within(alone), 0.999 * pixels);
  double low = 0, high = alone;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (pixels_within(middle) < pixels ? low : high) = middle;
  }
  double sum = 0;
  for (std::uint32_t i = 0; i < c.server_count; ++i) sum += pixels_of(i, high);
  const double on_link = std::max(0.0, high - start) / byte_ns, part = sum > on_link ? on_link / sum : 1;
  for (std::uint32_t i = 0; i < c.server_count; ++i)
    busy[i] = std::min(1.0, part * pixels_of(i, high) * prices[i] * crowd.servers[c.servers[i]].pixel_ns / high);
  return high;
}

}  // namespace

std::vector<double> crowd_equilibrium(const Crowd& crowd) {
  std::vector<double> demand(crowd.servers.size(), 0.0), next(demand.size()), times(crowd.clients.size());
  std::vector<double> busy(crowd.clients.size() * kServerCountMax, 0.0);
  for (int round = 0; round < kRounds; ++round) {
    std::fill(next.begin(), next.end(), 0.0);
    for (std::size_t k = 0; k < crowd.clients.size(); ++k) {
      const CrowdClient& c = crowd.clients[k];
      double* own = &busy[k * kServerCountMax];
      double prices[kServerCountMax], now[kServerCountMax];
      for (std::uint32_t i = 0; i < c.server_count; ++i) prices[i] = 1 + std::max(0.0, demand[c.servers[i]] - own[i]);
      times[k] = best_frame_ns(crowd, c, prices, now);
      for (std::uint32_t i = 0; i < c.server_count; ++i) {
        own[i] += kStep * (now[i] - own[i]);
        next[c.servers[i]] += own[i];
      }
    }
    demand = next;
  }
  return times;
}

double jain_index(const std::vector<double>& amounts) {
  double sum = 0, squares = 0;
  for (double x : amounts) sum += x, squares += x * x;
  return squares > 0 ? sum * sum / (static_cast<double>(amounts.size()) * squares) : 1;
}

}  // namespace pocketray
