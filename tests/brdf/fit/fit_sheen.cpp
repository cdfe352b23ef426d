// Writes brdf/sheen_table.h to the standard output: build/fit_sheen >src/brdf/sheen_table.h
//
// w starts as x Λ(x) of Estevez and Kulla's fit. Where the lobe would reflect more than kMost of uniform light, w is
// raised until it does not. Albedos are raised until the interpolated table is nowhere below the lobe's.
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

constexpr int kSide = 16, kFine = 4;  // places tested per step of the table
constexpr double kLeastRoughness = 0.07, kMost = 0.95, kPi = 3.14159265358979323846;

double roughness_at(double row) { return kLeastRoughness + (1 - kLeastRoughness) * row / (kSide - 1); }
double cosine_at(double column) {
  const double root = column / (kSide - 1);
  return std::max(root * root, 1e-6);
}

// Λ [Estevez & Kulla 2017, eq. 4 and table 1].
double exponent_of(double x, double alpha) {
  const double p = (1 - alpha) * (1 - alpha);
  auto mix = [p](double rough, double smooth) { return rough + (smooth - rough) * p; };
  return mix(21.5473, 25.3245) / (1 + mix(3.82987, 3.32435) * std::pow(x, mix(0.19823, 0.16801))) +
         mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967);
}
double lambda(double x, double alpha) {
  return x < 0.5 ? std::exp(exponent_of(x, alpha)) : std::exp(2 * exponent_of(0.5, alpha) - exponent_of(1 - x, alpha));
}

double w_table[kSide][kSide], albedo_table[kSide][kSide];

double between(const double (&table)[kSide][kSide], double row, double column) {
  const int r = std::min(static_cast<int>(row), kSide - 2), c = std::min(static_cast<int>(column), kSide - 2);
  const double s = row - r, t = column - c;
  return (table[r][c] * (1 - t) + table[r][c + 1] * t) * (1 - s) +
         (table[r + 1][c] * (1 - t) + table[r + 1][c + 1] * t) * s;
}

double albedo_at(double row, double column) {
  constexpr int kRings = 240, kSectors = 120;
  const double v = cosine_at(column), sine_v = std::sqrt(1 - v * v), r = roughness_at(row), inverse = 1 / (r * r);
  const double w_v = between(w_table, row, column);
  double sum = 0;
  for (int i = 0; i < kRings; ++i) {
    const double t = (i + 0.5) / kRings, l = t * t, sine_l = std::sqrt(1 - l * l);
    const double w_l = between(w_table, row, t * (kSide - 1));
    const double scale = (2 + inverse) / (2 * kPi) / (4 * (l * v + l * w_v + v * w_l));
    for (int k = 0; k < kSectors; ++k) {
      const double turn = kPi * (k + 0.5) / kSectors;
      const double across = sine_v * sine_v + sine_l * sine_l + 2 * sine_v * sine_l * std::cos(turn);
      const double sine_square = across / (across + (v + l) * (v + l));
      sum += std::pow(sine_square, inverse / 2) * scale * l * 2 * t;
    }
  }
  return sum * 2 * kPi / kRings / kSectors;
}

void fill_w(int row) {
  const double r = roughness_at(row);
  for (int c = 0; c < kSide; ++c) {
    const double x = cosine_at(c);
    w_table[row][c] = x * lambda(x, r * r);
  }
}

// Returns whether all albedos are below kMost.
bool raise_w(int row) {
  bool fits = true;
  double factor[kSide];
  std::fill(factor, factor + kSide, 1.0);
  for (int i = 0; i <= 2 * (kSide - 1); ++i) {
    const double albedo = albedo_at(row, i / 2.0);
    if (albedo <= kMost) continue;
    fits = false;
    for (int c : {i / 2, (i + 1) / 2}) factor[c] = std::max(factor[c], albedo / kMost * 1.001);
  }
  for (int c = 0; c < kSide; ++c) w_table[row][c] *= factor[c];
  return fits;
}

}  // namespace

int main() {
  for (int r = 0; r < kSide; ++r) {
    fill_w(r);
    if (r + 1 < kSide) fill_w(r + 1);
    while (!raise_w(r)) {
    }
    for (double& w : w_table[r]) w = std::ceil(w * 8192) / 8192;
  }
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) albedo_table[r][c] = albedo_at(r, c);
  double most = 0, most_raised = 0;
  for (int r = 0; r + 1 < kSide; ++r)
    for (int c = 0; c + 1 < kSide; ++c) {
      double lacking = 0;
      for (int i = 0; i <= kFine; ++i)
        for (int k = 0; k <= kFine; ++k) {
          const double row = r + double(i) / kFine, column = c + double(k) / kFine, albedo = albedo_at(row, column);
          most = std::max(most, albedo), lacking = std::max(lacking, albedo - between(albedo_table, row, column));
        }
      most_raised = std::max(most_raised, lacking);
      for (int i : {0, 1})
        for (int k : {0, 1}) albedo_table[r + i][c + k] += lacking;
    }
  std::printf(
      "// Written by tests/brdf/fit/fit_sheen.cpp: w of sheen.h in 1/8192, and the albedo for white in 1/65535.\n"
      "#pragma once\n#include <cstdint>\n\nnamespace pocketray {\n\nconstexpr int kSheenSide = %d;\n\n"
      "// Rows: roughness from %g to 1 in equal steps; columns: √(n·v) from 0 to 1.\n// clang-format off\n"
      "constexpr std::uint16_t kSheenTable[kSheenSide][kSheenSide][2] = {\n",
      kSide, kLeastRoughness);
  for (int r = 0; r < kSide; ++r) {
    std::printf("    {");
    for (int c = 0; c < kSide; ++c)
      std::printf("%s{%d, %d}", c ? ", " : "", static_cast<int>(w_table[r][c] * 8192 + 0.5),
                  static_cast<int>(std::ceil(albedo_table[r][c] * 65535)));
    std::printf("},\n");
  }
  std::printf("};\n// clang-format on\n\n}  // namespace pocketray\n");
  std::fprintf(stderr, "highest albedo %.4f; albedos raised by at most %.4f per cell\n", most, most_raised);
  return 0;
}
