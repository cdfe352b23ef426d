// Sampling an environment into its stored form.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "desktop/import/environment.h"
#include "desktop/import/environment_sun.h"

namespace pocketray {
namespace {

Vec3d place_in(std::uint32_t side, std::uint32_t column, std::uint32_t row, double s, double t) {
  return from_octahedral(2 * (column + s) / side - 1, 2 * (row + t) / side - 1);
}

EnvironmentMap empty_map(std::uint32_t side) {
  EnvironmentMap map;
  map.side = side;
  const std::size_t count = std::size_t(side) * side;
  map.radiance.assign(count, {0, 0, 0}), map.solid_angle.assign(count, 0), map.direction.resize(count);
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column)
      map.direction[std::size_t(row) * side + column] = normalize(place_in(side, column, row, 0.5, 0.5));
  return map;
}

EnvironmentMap sample_map(std::uint32_t side, std::uint32_t grid, const std::function<Vec3d(const Vec3d&)>& radiance) {
  CHECK(side >= 4 && side <= kEnvironmentSideMax && (side & (side - 1)) == 0 && grid >= 1);
  EnvironmentMap map = empty_map(side);
  for (std::size_t i = 0; i < map.radiance.size(); ++i) {
    const auto column = static_cast<std::uint32_t>(i % side), row = static_cast<std::uint32_t>(i / side);
    Vec3d sum = {0, 0, 0};
    double weights = 0;
    for (std::uint32_t k = 0; k < grid * grid; ++k) {
      const Vec3d p = place_in(side, column, row, (k % grid + 0.5) / grid, (k / grid + 0.5) / grid);
      const double square = dot(p, p), weight = 1 / (square * std::sqrt(square));
      Vec3d value = radiance(p / std::sqrt(square));
      for (int c = 0; c < 3; ++c) value[c] = value[c] > 0 ? value[c] : 0;
      sum += value * weight, weights += weight;
    }
    map.radiance[i] = sum / weights;
    map.solid_angle[i] = weights / (grid * grid) * 4 / (double(side) * side);
  }
  return map;
}

// Halves the side until it is at most `side`.
EnvironmentMap reduced(EnvironmentMap map, std::uint32_t side) {
  while (map.side > side) {
    EnvironmentMap half = empty_map(map.side / 2);
    for (std::size_t i = 0; i < map.radiance.size(); ++i) {
      const std::size_t to = i / map.side / 2 * half.side + i % map.side / 2;
      half.radiance[to] += map.radiance[i] * map.solid_angle[i], half.solid_angle[to] += map.solid_angle[i];
    }
    for (std::size_t i = 0; i < half.radiance.size(); ++i) half.radiance[i] = half.radiance[i] / half.solid_angle[i];
    map = std::move(half);
  }
  return map;
}

// A map with the means of its blocks of texels.
struct Pyramid {
  EnvironmentMap fine, coarse;
};
constexpr std::uint32_t kBlockSide = 4;
// Cosines between a block and a lobe's axis: near the axis, where the lobe is steep, and where the horizon may cut the
// block, its texels are counted one by one. A block of a map of 128² texels spans about 6°.
constexpr double kNearCosine = 0.9, kHorizonCosine = 0.15;

// Sum over the lobe for a viewer along the normal: weights D(n·h) n·l, as [Karis 2013] samples it, here over all
// texels. With 2 (n·h)² = 1 + n·l, D ∝ 1 / ((1 + n·l)/2 (α² − 1) + 1)².
struct LobeSum {
  double square;  // α²
  double weights = 0;
  Vec3d sum = {0, 0, 0};
  void add(const EnvironmentMap& map, std::size_t texel, double cosine) {
    if (!(cosine > 0)) return;
    const double term = (1 + std::fmin(cosine, 1)) / 2 * (square - 1) + 1;
    const double weight = cosine / (term * term) * map.solid_angle[texel];
    sum += map.radiance[texel] * weight, weights += weight;
  }
};

Vec3d lobe_mean(const Pyramid& map, const Vec3d& axis, double alpha) {
  LobeSum lobe = {alpha * alpha};
  auto add = [&](const EnvironmentMap& of, std::size_t texel) { lobe.add(of, texel, dot(of.direction[texel], axis)); };
  if (map.coarse.radiance.empty())
    for (std::size_t i = 0; i < map.fine.radiance.size(); ++i) add(map.fine, i);
  for (std::size_t i = 0; i < map.coarse.radiance.size(); ++i) {
    const double cosine = dot(map.coarse.direction[i], axis);
    if (cosine < -kHorizonCosine) continue;
    if (cosine > kHorizonCosine && cosine < kNearCosine) {
      add(map.coarse, i);
      continue;
    }
    const std::size_t row = i / map.coarse.side * kBlockSide, column = i % map.coarse.side * kBlockSide;
    for (std::size_t k = 0; k < kBlockSide * kBlockSide; ++k)
      add(map.fine, (row + k / kBlockSide) * map.fine.side + column + k % kBlockSide);
  }
  return lobe.sum / lobe.weights;
}

// Irradiance / π by [Ramamoorthi & Hanrahan 2001] eqs. 3, 9 and 10, as a polynomial in the normal; the bands have
// factors π, 2π/3 and π/4.
void add_irradiance(const EnvironmentMap& map, EnvironmentInfo* info) {
  constexpr double kNorm[9] = {0.25, 0.5, 0.5, 0.5, 15.0 / 16, 15.0 / 16, 15.0 / 16, 15.0 / 64, 5.0 / 64};
  Vec3d sum[9] = {};
  double all = 0;
  for (std::size_t i = 0; i < map.radiance.size(); ++i) {
    const Vec3d& n = map.direction[i];
    const double basis[9] = {
        1, n.x, n.y, n.z, n.x * n.y, n.y * n.z, n.x * n.z, n.x * n.x - n.z * n.z, 3 * n.y * n.y - 1};
    for (int k = 0; k < 9; ++k) sum[k] += map.radiance[i] * (basis[k] * map.solid_angle[i]);
    all += map.solid_angle[i];
  }
  for (int k = 0; k < 9; ++k)
    for (int c = 0; c < 3; ++c) info->irradiance[k][c] = static_cast<float>(sum[k][c] * (4 * kNorm[k] / all));
}

// Chooses a scale so that stored texels use their range.
Status choose_scale(const EnvironmentMap& map, EnvironmentInfo* info) {
  double most = 0;
  for (const Vec3d& radiance : map.radiance) most = std::fmax(most, max_component(radiance));
  if (!(most <= static_cast<double>(kEnvironmentTexelMax * kEnvironmentScaleMax) / 2))
    return failure("has a radiance of %g, more than can be stored: lower its exposure", most);
  info->scale = 1;
  while (most > static_cast<double>(kEnvironmentTexelMax * info->scale) / 2) info->scale *= 2;
  return success();
}

Status store(const EnvironmentMap& map, const EnvironmentMap& without_sun, ImportedEnvironment* environment) {
  EnvironmentInfo& info = environment->info;
  info.side = map.side, info.gloss_side = std::min(map.side, kGlossSide);
  RETURN_IF_ERROR(choose_scale(map, &info));
  environment->texels.clear();
  info.radiance_max = {0, 0, 0};
  auto store = [&](const Vec3d& color) {
    const std::uint32_t texel = to_environment_texel(color / static_cast<double>(info.scale));
    info.radiance_max = max(info.radiance_max, environment_texel(texel) * info.scale);
    environment->texels.push_back(texel);
  };
  for (const Vec3d& color : map.radiance) store(color);
  add_irradiance(without_sun, &info);
  environment->mean = max(info.irradiance[0], Vec3{0, 0, 0});
  Pyramid source = {reduced(without_sun, 2 * kGlossSide), {}};
  if (source.fine.side == 2 * kGlossSide) source.coarse = reduced(source.fine, source.fine.side / kBlockSide);
  for (int level = 0; level < kGlossLevelCount; ++level) {
    const double roughness = static_cast<double>(kGlossRoughness[level]);
    const std::uint32_t level_side = gloss_level_side(info.gloss_side, level);
    for (std::uint32_t i = 0; i < level_side * level_side; ++i)
      store(lobe_mean(source, normalize(place_in(level_side, i % level_side, i / level_side, 0.5, 0.5)),
                      roughness * roughness));
  }
  CHECK_EQ(environment->texels.size(), environment_texel_count(info.side, info.gloss_side));
  return success();
}

}  // namespace

Status make_environment(std::uint32_t side, std::uint32_t grid, const std::function<Vec3d(const Vec3d&)>& radiance,
                        ImportedEnvironment* environment) {
  CHECK(environment != nullptr);
  const EnvironmentMap map = sample_map(side, grid, radiance);
  return store(map, map, environment);
}

Status make_sunny_environment(std::uint32_t side, std::uint32_t grid,
                              const std::function<Vec3d(const Vec3d&)>& radiance, ImportedEnvironment* environment) {
  CHECK(environment != nullptr);
  const EnvironmentMap map = sample_map(side, grid, radiance);
  EnvironmentMap without_sun = map;
  take_sun(&without_sun, environment);
  return store(map, without_sun, environment);
}

}  // namespace pocketray
