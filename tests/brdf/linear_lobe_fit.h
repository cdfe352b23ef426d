// Fits linearly transformed powers of a cosine to the lobes; see brdf/linear_lobe.h. Only our own functions and IEEE
// arithmetic, so that the result is the same everywhere.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "brdf/linear_lobe.h"

namespace pocketray {

inline Material white_lobe(std::uint32_t brdf, double alpha) {
  Material m;
  m.brdf = brdf;
  m.specular = {1, 1, 1}, m.grazing = 1;
  m.roughness = static_cast<float>(alpha);
  m.exponent = static_cast<float>(2 / (alpha * alpha) - 2);
  return m;
}

inline double alpha_of_lobe(const Material& m) {
  if (m.brdf == kGgx) return static_cast<double>(m.roughness);
  return std::sqrt(2 / (static_cast<double>(m.exponent) + 2));
}

// Directions of light drawn from the lobe, on a grid of its sampling, and its sharp part times the cosine there as a
// density whose integral is 1.
struct LobeSample {
  Vec3d direction;
  double density, weight;  // ∫ h dω = Σ weight · h
};
struct LobeSamples {
  std::vector<LobeSample> samples;
  double albedo = 0;
};
inline LobeSamples sample_lobe(const Material& m, const Vec3d& to_viewer, int side) {
  const BrdfInfo& brdf = *kBrdfList[m.brdf];
  const LobeFrameD frame = {{0, 0, 1}, {0, 0, 0}};
  const Vec3d white = to_double(m.specular), none = {0, 0, 0};
  LobeSamples result;
  LobePartsD parts;
  brdf.linear->divide_exactly(m, white, none, frame, to_viewer, &parts);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const Vec3d l = brdf.sample(m, frame, to_viewer, (i + 0.5) / side, (j + 0.5) / side);
      if (!(l.z > 0)) continue;
      const double density = brdf.density(m, frame, to_viewer, l);
      if (!(density > 0)) continue;
      double value = brdf.exact_value(m, white, none, frame, to_viewer, l).x;
      if (brdf.linear->exact_rest) value -= brdf.linear->exact_rest(parts, l.z).x;
      const double weight = 1 / (density * side * side);
      result.samples.push_back({l, std::max(value, 0.0) * l.z, weight});
      result.albedo += std::max(value, 0.0) * l.z * weight;
    }
  for (LobeSample& s : result.samples) s.density /= result.albedo;
  return result;
}

inline double odd_power(double x, std::uint32_t n) {
  double result = x;
  for (std::uint32_t i = 1; i < n; ++i) result *= x;
  return result;
}

// D at a unit direction.
inline double linear_density(const LobePartsD& lobe, std::uint32_t power, const Vec3d& direction) {
  const double x = dot(lobe.x, direction), y = dot(lobe.y, direction), z = dot(lobe.z, direction);
  if (!(z > 0)) return 0;
  const double square = x * x + y * y + z * z, size = std::sqrt(square);
  const double volume = std::fabs(dot(lobe.x, cross(lobe.y, lobe.z)));
  return (power + 1) / (2 * kPi) * odd_power(z / size, power) * volume / (square * size);
}

// The share of D above the horizon of z, for M⁻¹ that is symmetric about the xz plane: ∫ cos^m over the angles from one
// end of the plane z' = 0 to the horizon, seen along the y axis.
inline double share_above_horizon(const LobePartsD& lobe, std::uint32_t power) {
  const double determinant = lobe.x.x * lobe.z.z - lobe.x.z * lobe.z.x;  // row z of M is (−z.x, x.x) over it
  const double x = -lobe.z.x / determinant, z = lobe.x.x / determinant;
  auto integral = [power](double s) {  // ∫ (1 − s²)^((m − 1)/2) ds
    double sum = 0, term = s;
    const int n = static_cast<int>(power - 1) / 2;
    for (int k = 0; k <= n; ++k) {
      sum += term / (2 * k + 1);
      term *= -s * s * (n - k) / (k + 1);
    }
    return sum;
  };
  return (integral(z / std::sqrt(x * x + z * z)) / integral(1) + 1) / 2;
}

// Half of ∫ |p − D|, p being the lobe and D its fit, both with all of it above the horizon: of any lamp's light at most
// that share is missing or too much, whatever its form.
inline double misplaced_light(const LobeSamples& lobe, const LobePartsD& fit, std::uint32_t power) {
  const double above = share_above_horizon(fit, power);
  if (!(above > 0.05)) return 1;
  double sum = 0;
  for (const LobeSample& s : lobe.samples)
    sum += std::max(s.density - linear_density(fit, power, s.direction) / above, 0.0) * s.weight;
  return sum;
}

constexpr int kLinearFitSide = 64;  // of the grid of samples that the tables are fitted to

// Minimises by the simplex of [Nelder & Mead 1965]; returns the least value.
template <int n, class Function>
double minimize(Function f, double (&x)[n], double step) {
  double corner[n + 1][n], value[n + 1];
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k < n; ++k) corner[i][k] = x[k] + (i == k + 1 ? step : 0);
    value[i] = f(corner[i]);
  }
  auto swap = [&](int a, int b) {
    std::swap(value[a], value[b]);
    for (int k = 0; k < n; ++k) std::swap(corner[a][k], corner[b][k]);
  };
  for (int round = 0; round < 400; ++round) {
    for (int i = 1; i <= n; ++i)
      for (int j = i; j > 0 && value[j] < value[j - 1]; --j) swap(j, j - 1);
    if (value[n] - value[0] < 1e-8) break;
    double middle[n] = {}, tried[2][n];
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) middle[k] += corner[i][k] / n;
    auto at = [&](double place, double(&point)[n]) {
      for (int k = 0; k < n; ++k) point[k] = middle[k] + place * (corner[n][k] - middle[k]);
      return f(point);
    };
    auto take = [&](const double(&point)[n], double v) {
      for (int k = 0; k < n; ++k) corner[n][k] = point[k];
      value[n] = v;
    };
    const double mirrored = at(-1, tried[0]);
    if (mirrored < value[n - 1]) {
      const double further = mirrored < value[0] ? at(-2, tried[1]) : mirrored;
      further < mirrored ? take(tried[1], further) : take(tried[0], mirrored);
      continue;
    }
    const double nearer = at(mirrored < value[n] ? -0.5 : 0.5, tried[1]);
    if (nearer < std::min(mirrored, value[n])) {
      take(tried[1], nearer);
      continue;
    }
    for (int i = 1; i <= n; ++i) {
      for (int k = 0; k < n; ++k) corner[i][k] = (corner[i][k] + corner[0][k]) / 2;
      value[i] = f(corner[i]);
    }
  }
  const int best = static_cast<int>(std::min_element(value, value + n + 1) - value);
  for (int k = 0; k < n; ++k) x[k] = corner[best][k];
  return value[best];
}

// A table's rows and columns.
inline double root_at(int index, double step) { return 0.1 + index * step; }

// `parameters` are those of the tables; of a round lobe, as seen along the normal, the last two of GGX and the third of
// Phong mean nothing.
struct LinearFit {
  double parameters[4];
  double misplaced;
};

inline LinearFit fit_linear_lobe(std::uint32_t brdf, double alpha, double cosine, int side) {
  const double sine = std::sqrt(1 - cosine * cosine);
  const Vec3d normal = {0, 0, 1}, to_viewer = {-sine, 0, cosine};
  const Material m = white_lobe(brdf, alpha);
  const std::uint32_t power = kBrdfList[brdf]->linear->power;
  const LobeSamples samples = sample_lobe(m, to_viewer, side);
  const ViewerPlane<double> plane(normal, to_viewer);
  const bool is_round = sine < 1e-3;
  auto lobe_of = [&](const double(&x)[4]) {
    const double p[4] = {x[0], is_round ? (brdf == kGgx ? x[0] * x[0] : x[0]) : x[1], is_round ? 0 : x[2], x[3]};
    LobePartsD lobe;
    double above;
    if (brdf == kGgx)
      set_ggx_lobe(normal, plane, alpha, p, &lobe, &above);
    else
      set_phong_lobe(normal, plane, alpha, p, &lobe);
    return lobe;
  };
  auto error = [&](const double(&x)[4]) {
    for (double v : x)
      if (!(v >= 0 && v <= 1.9)) return 1.0;
    return misplaced_light(samples, lobe_of(x), power);
  };
  const double wide = 2 * alpha / cosine;  // start near what sharp and rough lobes have
  double x[4] = {std::sqrt((cosine * cosine + 4 * alpha * alpha) / 2), 0.5, 1 / (1 + wide * wide / 2),
                 is_round ? 0 : 0.7 * cosine};
  if (brdf == kPhong) x[0] = x[1] = 0.46, x[2] = 0.2, x[3] = 0;
  LinearFit fit;
  for (double step : {0.1, 0.05, 0.02, 0.02}) fit.misplaced = minimize<4>(error, x, step);
  if (is_round) x[1] = brdf == kGgx ? x[0] * x[0] : x[0];
  for (int k = 0; k < 4; ++k) fit.parameters[k] = x[k];
  if (brdf == kPhong) fit.parameters[3] = samples.albedo / share_above_horizon(lobe_of(x), power);
  return fit;
}

}  // namespace pocketray
