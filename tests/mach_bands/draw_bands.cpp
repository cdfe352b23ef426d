// draw_bands FOLDER: the table and the pictures of `make mach-bands`: the cube by each reconstruction of radiosity, and
// what lateral inhibition makes of it. See tests/radiosity/mach_bands.h.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/color.h"
#include "radiosity/mach_bands.h"

using namespace pocketray;

namespace {

constexpr int kReferenceCells = 24;

bool write_ppm(const std::string& path, const std::vector<std::uint8_t>& rgb) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return std::fprintf(stderr, "draw_bands: cannot write %s\n", path.c_str()), false;
  std::fprintf(file, "P6\n%u %u\n255\n", kBandsWidth, kBandsHeight);
  const bool written = std::fwrite(rgb.data(), 1, rgb.size(), file) == rgb.size();
  return std::fclose(file) == 0 && written;
}

std::vector<std::uint8_t> as_displayed(const Picture& picture) {
  std::vector<std::uint8_t> rgb;
  for (const Vec3& light : picture)
    for (int c = 0; c < 3; ++c) rgb.push_back(srgb_level(std::min(1.0f, light[c])));
  return rgb;
}

// Grey where nothing is seen that is not there; bright and dark bands, eight levels of 255 as black or white.
std::vector<std::uint8_t> as_bands(const std::vector<double>& response) {
  std::vector<std::uint8_t> rgb;
  for (double r : response) {
    const double level = std::min(255.0, std::max(0.0, 128 + 128 * r / (8 / 255.0)));
    rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(level));
  }
  return rgb;
}

int run(const std::string& folder) {
  const struct {
    const char* name;
    Reconstruction reconstruction;
  } methods[] = {{"constant", Reconstruction::constant},
                 {"bilinear", Reconstruction::bilinear},
                 {"bicubic", Reconstruction::bicubic}};
  BandsRig rig;
  const Picture reference = rig.render(kReferenceCells, Reconstruction::bicubic);
  if (!write_ppm(folder + "/reference.ppm", as_displayed(reference))) return 1;
  std::printf("%-6s %-9s %10s %14s %12s %10s\n", "cells", "method", "RMSE", "2nd difference", "response", "its most");
  for (int cells : {2, 3, 4, 6, 8, 12})
    for (const auto& method : methods) {
      const Picture picture = rig.render(cells, method.reconstruction);
      const Bands bands = rig.measure(picture, reference);
      std::printf("%-6d %-9s %10.5f %14.3g %12.6f %10.5f\n", cells, method.name, bands.rmse, bands.second_difference,
                  bands.rms, bands.most);
      if (cells != 2) continue;
      const std::string start = folder + "/" + method.name;
      if (!write_ppm(start + ".ppm", as_displayed(picture)) ||
          !write_ppm(start + "-bands.ppm", as_bands(bands.response)))
        return 1;
    }
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]), 2;
  doctest::Context context;  // REQUIRE ends the program with a message
  context.setAsDefaultForAssertsOutOfTestCases();
  context.setAssertHandler([](const doctest::AssertData& a) {
    std::fprintf(stderr, "%s:%d: %s is not true\n", a.m_file, a.m_line, a.m_expr);
    std::exit(1);
  });
  return run(arguments[1]);
}
