// Compares two picture files.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "app/accuracy/linear_picture.h"
#include "base/status.h"
#include "base/tone.h"
#include "desktop/accuracy/errors.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

constexpr std::size_t kComparedPixelsMax = std::size_t{1} << 24;  // comparing takes about 300 bytes per pixel

// A picture of either kind, as its file stores it.
struct AnyPicture {
  bool is_linear = false;
  LinearPicture light;  // if linear
  Levels levels;        // otherwise
  std::uint32_t width() const { return is_linear ? light.width : levels.width; }
  std::uint32_t height() const { return is_linear ? light.height : levels.height; }
};

// Reads a PPM (8-bit P6) or, in builds that import models, a PNG or JPEG as 8-bit levels, without alpha; a PFM or
// OpenEXR picture as linear light. Refuses truncated files, pictures of more than kComparedPixelsMax pixels and values
// that are not finite.
Status read_picture(const std::string& path, AnyPicture* picture);

// How to develop linear light. The display shows exposure × radiance, by the tone's curve.
struct Development {
  bool measured = false;  // exposure: to middle grey, of the reference if that is linear, otherwise of the test
  double exposure = 1;    // otherwise this
  bool aligned = false;   // scale the test's light to the reference's, or expose light to be closest to levels
  Tone tone = Tone::clip;
};

struct Comparison {
  double flip = 0, flip_max = 0;    // mean and maximum of the map
  std::vector<float> flip_map;      // ꟻLIP of each pixel, row 0 on top
  PictureErrors errors;             // as displayed, with 1 as white
  std::size_t differing_count = 0;  // pixels in which any channel differs: radiance of two linear pictures, else levels
  bool are_linear = false;          // both
  PictureErrors light;              // differences of radiance, if both are linear
  bool has_exposure = false;        // either is linear
  double exposure = 1;              // used, in `aligned` of light and levels as found
  double scale = 1;                 // factor on the test's radiance, if both are linear and aligned
};

// Both must have the same size.
Comparison compare_levels(const Levels& reference, const Levels& test, double pixels_per_degree);
// Two linear pictures are compared in radiance and, exposed and encoded as sRGB, as displayed. Linear light beside
// levels is exposed and quantised. Both must have the same size. Fails if they cannot be aligned.
Status compare_pictures(const AnyPicture& reference, const AnyPicture& test, const Development& development,
                        double pixels_per_degree, Comparison* comparison);

}  // namespace pocketray
