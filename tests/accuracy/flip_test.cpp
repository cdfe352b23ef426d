// ꟻLIP against the authors' own program.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "desktop/accuracy/flip.h"
#ifdef POCKETRAY_HAVE_PNG
#include <png.h>
#endif

using namespace pocketray;

namespace {

struct Picture {
  std::size_t width = 0, height = 0;
  std::vector<float> srgb;
};

#ifdef POCKETRAY_HAVE_PNG
Picture read_png(const std::string& path) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  REQUIRE_MESSAGE(png_image_begin_read_from_file(&png, path.c_str()), path);
  png.format = PNG_FORMAT_RGB;
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(png));
  REQUIRE(png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr));
  Picture picture = {png.width, png.height, {}};
  for (png_byte b : bytes) picture.srgb.push_back(static_cast<float>(b) / 255);
  return picture;
}
#endif

}  // namespace

// Goal: errors match the authors' program: means to 1e-4, maxima to 1e-3. Method: their values for four kinds of errors
// at two distances, if the pictures are available.
TEST_CASE("flip_equals_the_authors") {
  std::string folder = std::string(POCKETRAY_SHARED) + "/flip/";
  std::ifstream table(folder + "expected.csv");
  if (!table) {
    MESSAGE("skipped: no " << folder << "expected.csv");
    return;
  }
#ifdef POCKETRAY_HAVE_PNG
  Picture reference = read_png(folder + "ref.png");
  std::string line;
  std::getline(table, line);
  int count = 0;
  while (std::getline(table, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::string name;
    double pixels_per_degree, mean, weighted_median, max;
    cells >> name >> pixels_per_degree >> mean >> weighted_median >> max;
    REQUIRE(!cells.fail());
    Picture test = read_png(folder + name);
    REQUIRE(test.srgb.size() == reference.srgb.size());
    std::vector<float> errors = flip_errors(reference.srgb, test.srgb, test.width, test.height, pixels_per_degree);
    double sum = 0;
    for (float e : errors) sum += e;
    CAPTURE(line);
    CHECK(std::fabs(sum / static_cast<double>(errors.size()) - mean) <= 1e-4);
    CHECK(std::fabs(*std::max_element(errors.begin(), errors.end()) - max) <= 1e-3);
    ++count;
  }
  CHECK(count >= 8);
#else
  MESSAGE("skipped: this build reads no PNG");
#endif
}

// Goal: errors lie in [0, 1], are 0 for equal pictures and symmetric; black against white is large, whatever the size.
// Method: pictures of one pixel, of one row, and narrower than the filters.
TEST_CASE("flip_errors_keep_to_their_range") {
  for (std::size_t width : {1u, 3u, 40u})
    for (std::size_t height : {1u, 5u}) {
      std::vector<float> black(3 * width * height, 0.0f), white(3 * width * height, 1.0f), mixed = black;
      for (std::size_t i = 0; i < mixed.size(); i += 2) mixed[i] = 1;
      for (double distance : {kHandheldPixelsPerDegree, 67.0}) {
        for (float e : flip_errors(mixed, mixed, width, height, distance)) CHECK(e == 0);
        for (float e : flip_errors(black, white, width, height, distance)) CHECK((e > 0.9f && e <= 1));
        std::vector<float> one = flip_errors(black, mixed, width, height, distance);
        CHECK(one == flip_errors(mixed, black, width, height, distance));
        for (float e : one) CHECK((e >= 0 && e <= 1));
      }
    }
}
