// draw_bands FOLDER: the table and the pictures of `make mach-bands`: the cube by each reconstruction of radiosity, and
// what lateral inhibition makes of it. See tests/radiosity/mach_bands.h.
// draw_bands METHOD quads|triangles: one frame of eight patches a side, whose instructions are counted by
//   valgrind --tool=callgrind --collect-atstart=no --toggle-collect='pocketray::trace_spans*'
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/color.h"
#include "effect/setting_list.h"
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

constexpr Reconstruction kMethods[] = {Reconstruction::constant, Reconstruction::bilinear, Reconstruction::quadratic,
                                       Reconstruction::cubic, Reconstruction::bicubic};

const char* name_of(Reconstruction method, Pieces pieces) {
  if (method == Reconstruction::bilinear && pieces == Pieces::triangles) return "linear";
  return kReconstructionNames[static_cast<int>(method)];
}

// The table of one kind of light on one kind of pieces; with a start of names, pictures of two patches a side.
bool measure(BandsRig* rig, const Picture& reference, const char* light, Pieces pieces, const std::string& start) {
  const bool on_triangles = pieces == Pieces::triangles;
  for (int cells : {2, 3, 4, 6, 8, 12})
    for (Reconstruction method : kMethods) {
      if (on_triangles && method == Reconstruction::bicubic) continue;  // linear
      const Picture picture = rig->render(cells, method, pieces);
      const Bands bands = rig->measure(picture, reference);
      const char* name = name_of(method, pieces);
      std::printf("%-8s %-9s %5d %6zu %-9s %9.5f %14.3g %10.6f %9.5f\n", light, on_triangles ? "triangles" : "quads",
                  cells, rig->value_count(), name, bands.rmse, bands.second_difference, bands.rms, bands.most);
      if (cells != 2 || start.empty()) continue;
      if (!write_ppm(start + name + ".ppm", as_displayed(picture)) ||
          !write_ppm(start + name + "-bands.ppm", as_bands(bands.response)))
        return false;
    }
  return true;
}

int run(const std::string& folder) {
  std::printf("%-8s %-9s %5s %6s %-9s %9s %14s %10s %9s\n", "light", "pieces", "cells", "values", "method", "RMSE",
              "2nd difference", "response", "its most");
  for (bool total : {true, false}) {
    BandsRig rig(total);
    const char* light = total ? "total" : "indirect";
    const Picture reference = rig.render(kReferenceCells, Reconstruction::bicubic);
    if (total && !write_ppm(folder + "/reference.ppm", as_displayed(reference))) return 1;
    for (Pieces pieces : {Pieces::quads, Pieces::triangles}) {
      const std::string start = !total ? "" : pieces == Pieces::quads ? folder + "/" : folder + "/triangles-";
      if (!measure(&rig, reference, light, pieces, start)) return 1;
    }
  }
  return 0;
}

// One frame, for valgrind to count.
int run_once(const std::string& method, const std::string& pieces) {
  for (Reconstruction m : kMethods)
    for (Pieces p : {Pieces::quads, Pieces::triangles})
      if (method == name_of(m, p) && pieces == (p == Pieces::quads ? "quads" : "triangles"))
        return BandsRig().render(8, m, p), 0;
  return std::fprintf(stderr, "draw_bands: no %s on %s\n", method.c_str(), pieces.c_str()), 2;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2 && argument_count != 3)
    return std::fprintf(stderr, "usage: %s FOLDER | METHOD quads|triangles\n", arguments[0]), 2;
  doctest::Context context;  // REQUIRE ends the program with a message
  context.setAsDefaultForAssertsOutOfTestCases();
  context.setAssertHandler([](const doctest::AssertData& a) {
    std::fprintf(stderr, "%s:%d: %s is not true\n", a.m_file, a.m_line, a.m_expr);
    std::exit(1);
  });
  return argument_count == 3 ? run_once(arguments[1], arguments[2]) : run(arguments[1]);
}
