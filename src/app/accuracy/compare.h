// Compares two picture files.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "base/status.h"
#include "desktop/accuracy/errors.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

constexpr std::size_t kComparedPixelsMax = std::size_t{1} << 24;  // comparing takes about 300 bytes per pixel

// Reads a PPM (8-bit P6) or, in builds that import models, a PNG or JPEG as 8-bit levels, without alpha. Refuses
// truncated files and pictures of more than kComparedPixelsMax pixels.
Status read_picture(const std::string& path, Levels* picture);

struct Comparison {
  double flip = 0, flip_max = 0;    // mean and maximum of the map
  std::vector<float> flip_map;      // ꟻLIP of each pixel, row 0 on top
  PictureErrors errors;             // of the levels, with 1 as white
  std::size_t differing_count = 0;  // pixels in which any channel differs
};

// Both must have the same size.
Comparison compare_pictures(const Levels& reference, const Levels& test, double pixels_per_degree);

}  // namespace pocketray
