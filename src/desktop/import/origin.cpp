#include "desktop/import/origin.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/check.h"

namespace pocketray {
namespace {

// Number with the fewest decimals, or the most trailing zeros, within `error` of x: offsets of models are mostly such.
double rounded_within(double x, double error) {
  for (double unit = 1e7; unit >= 1; unit /= 10)
    if (std::fabs(std::floor(x / unit + 0.5) * unit - x) <= error) return std::floor(x / unit + 0.5) * unit;
  for (double parts = 10; parts <= 1e9; parts *= 10)
    if (std::fabs(std::floor(x * parts + 0.5) / parts - x) <= error) return std::floor(x * parts + 0.5) / parts;
  return x;
}

// Weighted quantile: the value below which a share of the samples' weight lies.
template <class Value>
double quantile(const std::vector<ExactExtent::Sample>& samples, double share, Value value) {
  std::vector<std::pair<double, double>> sorted;  // value, weight
  double sum = 0, below = 0;
  for (const ExactExtent::Sample& sample : samples) {
    sorted.emplace_back(value(sample.place), sample.weight);
    sum += sample.weight;
  }
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [at, weight] : sorted)
    if ((below += weight) >= share * sum) return at;
  CHECK(!sorted.empty());
  return sorted.back().first;
}

// Bounds without the outermost twentieth on each side.
ExactBox bounds_of_most(const std::vector<ExactExtent::Sample>& samples) {
  constexpr double kLeftOut = .05;  // chosen: more than strays, less than a part that matters
  ExactBox box;
  for (int c = 0; c < 3; ++c) {
    auto value = [&](const Vec3d& place) { return place[c]; };
    box.low[c] = quantile(samples, kLeftOut, value), box.high[c] = quantile(samples, 1 - kLeftOut, value);
  }
  return box;
}

// Displacement of the median position by rounding.
double median_error(const std::vector<ExactExtent::Sample>& samples, const Vec3d& origin) {
  return quantile(samples, .5, [&](const Vec3d& place) {
    const Vec3d left = place - origin;
    return length(to_double(to_float(left)) - left);
  });
}

Vec3d middle_of(const ExactBox& bounds) {
  const double error = length(bounds.high - bounds.low) * 0x1p-20;
  Vec3d middle;
  for (int c = 0; c < 3; ++c) middle[c] = rounded_within((bounds.low[c] + bounds.high[c]) / 2, error);
  return middle;
}

// Returns false if the model stays where it is.
bool find_origin(const ExactExtent& extent, Vec3d* origin) {
  if (extent.samples.empty()) return false;
  const bool all = is_far(extent.bounds, extent.triangle_count);
  const ExactBox bounds = all ? extent.bounds : bounds_of_most(extent.samples);
  if (!all && !is_far(bounds, extent.triangle_count)) return false;
  *origin = middle_of(bounds);
  return all || median_error(extent.samples, *origin) < median_error(extent.samples, {0, 0, 0});
}

}  // namespace

bool is_far(const ExactBox& bounds, double triangle_count) {
  // A typical edge must lose its last 10 of 24 bits, and the model must be farther away than twice its size: so most of
  // the loss comes from the offset, and ordinary models keep their bits.
  constexpr double kLossMax = 0x1p-10, kDistanceMin = 2;
  const Vec3d size = bounds.high - bounds.low, middle = (bounds.low + bounds.high) * 0.5;
  if (!is_exact_coordinate(bounds.low) || !is_exact_coordinate(bounds.high)) return false;
  const double diagonal = length(size), distance = length(middle);
  if (!(diagonal > 0) || !(distance > kDistanceMin * diagonal)) return false;
  const double edge = diagonal / std::sqrt(std::max(triangle_count, 1.0));
  return distance * static_cast<double>(std::numeric_limits<float>::epsilon()) > kLossMax * edge;
}

Vec3d choose_origin(const ExactExtent& extent, SceneBuilder* builder) {
  CHECK(builder->out->origin.empty());  // chosen once
  Vec3d origin;
  if (!find_origin(extent, &origin)) return {0, 0, 0};
  builder->out->origin.push_back({origin.x, origin.y, origin.z});
  char told[200];
  std::snprintf(told, sizeof told,
                "the model is far from the origin, so it is moved by (%.12g, %.12g, %.12g) to keep its shape; --camera "
                "and --aov position use its own coordinates",
                -origin.x, -origin.y, -origin.z);
  note_remark(builder, told);
  return origin;
}

Vec3d origin_of(const SceneBuilder& builder) {
  if (builder.out->origin.empty()) return {0, 0, 0};
  const SceneOrigin& origin = builder.out->origin[0];
  return {origin.x, origin.y, origin.z};
}

Vec3d turned_back(const Transform& turn, const Vec3d& v) {
  auto back = [&](int c) {  // by the transpose
    return static_cast<double>(turn.m[0][c]) * v.x + static_cast<double>(turn.m[1][c]) * v.y +
           static_cast<double>(turn.m[2][c]) * v.z;
  };
  return {back(0), back(1), back(2)};
}

void recentre(const std::vector<Vec3d>& positions, const Transform& turn, double triangle_count, SceneBuilder* builder,
              std::vector<Vec3>* rounded) {
  ExactExtent extent;
  add_points(
      &extent, positions.size(), [&](std::size_t i) { return positions[i]; }, exact(turn), triangle_count);
  const Vec3d origin = turned_back(turn, choose_origin(extent, builder));
  if (builder->out->origin.empty()) return;
  CHECK_EQ(positions.size(), rounded->size());
  for (std::size_t i = 0; i < positions.size(); ++i) (*rounded)[i] = to_float(positions[i] - origin);
}

}  // namespace pocketray
