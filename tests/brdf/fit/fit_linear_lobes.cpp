// Writes brdf/linear_lobe_table.h to the standard output: build/fit_linear_lobes >src/brdf/linear_lobe_table.h
#include <cstdio>

#include "brdf/linear_lobe_fit.h"

using namespace pocketray;

namespace {

void write_table(const char* name, std::uint32_t brdf, int rows, double step, int columns) {
  std::printf("constexpr std::uint16_t %s[%d][%d][4] = {\n", name, rows, columns);
  double worst = 0, sum = 0;
  for (int i = 0; i < rows; ++i) {
    std::printf("    {");
    LinearFit fits[64];
    for (int j = 0; j < columns; ++j) {
      const double row = root_at(i, step), column = root_at(j, 0.9 / (columns - 1));
      fits[j] = fit_linear_lobe(brdf, row * row, std::min(column * column, 1.0), kLinearFitSide);
      worst = std::max(worst, fits[j].misplaced), sum += fits[j].misplaced / (rows * columns);
    }
    LinearFit &round = fits[columns - 1], &next = fits[columns - 2];
    round.parameters[2] = next.parameters[2];
    if (brdf == kGgx) round.parameters[3] = next.parameters[3];
    for (int j = 0; j < columns; ++j) {
      std::printf("%s{", j ? ", " : "");
      for (int k = 0; k < 4; ++k)
        std::printf("%s%d", k ? ", " : "", static_cast<int>(fits[j].parameters[k] / kLinearUnit + 0.5));
      std::printf("}");
    }
    std::printf("},\n");
  }
  std::printf("};\n");
  std::fprintf(stderr, "%s: light in the wrong place at most %.3f, %.3f in the mean\n", name, worst, sum);
}

}  // namespace

int main() {
  std::printf(
      "// Written by tests/brdf/fit/fit_linear_lobes.cpp: the parameters of linear_lobe.h, in kLinearUnit.\n"
      "#pragma once\n#include <cstddef>\n#include <cstdint>\n\nnamespace pocketray {\n\n"
      "constexpr double kLinearUnit = 1.0 / 32768;\n\n// Steps of √α.\n"
      "constexpr double kGgxLinearStep = 0.06, kPhongLinearStep = 0.065;\n\n"
      "constexpr std::uint32_t kPhongLinearPower = 9;\n"
      "constexpr double kPhongLinearAlphaMax = 0.5625;  // wider lobes are the sum of a lamp's points\n\n"
      "// clang-format off\n// g, 1/t, b, k\n");
  write_table("kGgxLinear", kGgx, 16, kGgxLinearStep, 16);
  std::printf("\n// 1/a, 1/t, b, albedo\n");
  write_table("kPhongLinear", kPhong, 11, kPhongLinearStep, 16);
  std::printf("// clang-format on\n\n}  // namespace pocketray\n");
  return 0;
}
