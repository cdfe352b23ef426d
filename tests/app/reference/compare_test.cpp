// Comparing picture files.
#include "app/accuracy/compare.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "desktop/accuracy/flip.h"
#include "desktop/accuracy/strip.h"
#include "support/picture_folder.h"

using namespace pocketray;

namespace {

Levels constant(std::uint32_t width, std::uint32_t height, std::uint8_t level) {
  return {width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height, level)};
}

}  // namespace

// Goal: RMSE, PSNR and the largest difference of two constant pictures are those of their levels; equal pictures have
// no error. Method: levels 51 and 102 differ by 0.2; one pixel of 12 differs in one channel by 51.
TEST_CASE("compare_equals_the_closed_form") {
  Comparison c = compare_levels(constant(4, 3, 51), constant(4, 3, 102), kHandheldPixelsPerDegree);
  CHECK(c.errors.rmse == doctest::Approx(0.2).epsilon(1e-12));
  CHECK(c.errors.psnr == doctest::Approx(20 * std::log10(5.0)).epsilon(1e-12));
  CHECK(c.errors.max == doctest::Approx(0.2).epsilon(1e-12));
  CHECK(c.differing_count == 12);
  CHECK(c.flip_map.size() == 12);
  CHECK((c.flip > 0 && c.flip <= c.flip_max));
  Levels spot = constant(4, 3, 51);
  spot.rgb[3 * 7 + 2] = 102;
  c = compare_levels(constant(4, 3, 51), spot, kHandheldPixelsPerDegree);
  CHECK(c.differing_count == 1);
  CHECK(c.errors.rmse == doctest::Approx(0.2 / 6).epsilon(1e-12));
  CHECK(c.flip_max > c.flip);
  c = compare_levels(spot, spot, kHandheldPixelsPerDegree);
  CHECK(c.flip == 0);
  CHECK(c.flip_max == 0);
  CHECK(c.errors.rmse == 0);
  CHECK(std::isinf(c.errors.psnr));
  CHECK(c.differing_count == 0);
}

// Goal: a picture is read as it was written; no prefix of it is that lacks a pixel. Method: PPM with
// comments, and PNG, which ends with 12 bytes without pixels; each prefix.
TEST_CASE("compare_reads_whole_pictures_only") {
  PictureFolder folder;
  Levels picture = constant(5, 3, 0);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] = static_cast<std::uint8_t>(17 * i);
  std::string png, ppm = "P6 # made by hand\n#\n5 3\n# three rows\n255\n";
  REQUIRE(encode_png(picture, &png).ok);
  ppm.append(picture.rgb.begin(), picture.rgb.end());
  std::vector<std::string> files = {ppm};
#ifdef POCKETRAY_HAVE_IMPORT
  files.push_back(png);
#endif
  const std::string path = std::string(folder.path) + "/picture";
  for (const std::string& file : files) {
    AnyPicture read;
    save(path, file);
    Status status = read_picture(path, &read);
    REQUIRE_MESSAGE(status.ok, status.message);
    CHECK(read.width() == 5);
    CHECK(read.height() == 3);
    CHECK(read.levels.rgb == picture.rgb);
    for (std::size_t count = 0; count < file.size(); ++count) {
      save(path, file.substr(0, count));
      status = read_picture(path, &read);
      CAPTURE(count);
      if (file == png && count + 12 >= file.size()) {
        CHECK((!status.ok || read.levels.rgb == picture.rgb));
      } else {
        CHECK(!status.ok);
        CHECK(std::string(status.message).find(path) != std::string::npos);
      }
    }
  }
  for (const char* header : {"P6 0 3 255 ", "P6 99999999999999999999 1 255 ", "P6 4097 4096 255 ", "P6 1 1 65535 ",
                             "P6 -1 1 255 ", "P3 1 1 255 0 0 0", "GIF89a"}) {
    AnyPicture read;
    save(path, header + std::string(60, ' '));
    CAPTURE(header);
    CHECK(!read_picture(path, &read).ok);
  }
}

// Goal: means equal the authors' program to 1e-4, largest errors to 1e-3, from files on. Method: their values at two
// distances, if the pictures are available.
TEST_CASE("compare_equals_the_authors_of_flip") {
#ifdef POCKETRAY_HAVE_IMPORT
  std::string folder = std::string(POCKETRAY_SHARED) + "/flip/", line;
  std::ifstream table(folder + "expected.csv");
  if (!table) {
    MESSAGE("skipped: no " << folder << "expected.csv");
    return;
  }
  AnyPicture reference, test;
  REQUIRE(read_picture(folder + "ref.png", &reference).ok);
  std::getline(table, line);
  int count = 0;
  for (; std::getline(table, line); ++count) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::string name;
    double pixels_per_degree, mean, median, max;
    cells >> name >> pixels_per_degree >> mean >> median >> max;
    REQUIRE(!cells.fail());
    REQUIRE(read_picture(folder + name, &test).ok);
    Comparison c = compare_levels(reference.levels, test.levels, pixels_per_degree);
    CAPTURE(line);
    CHECK(std::fabs(c.flip - mean) <= 1e-4);
    CHECK(std::fabs(c.flip_max - max) <= 1e-3);
  }
  CHECK(count >= 8);
#else
  MESSAGE("skipped: this build reads no PNG");
#endif
}
