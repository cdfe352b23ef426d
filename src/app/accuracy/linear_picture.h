// Pictures in linear light, from files.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/status.h"
#include "base/vec3.h"

namespace pocketray {

struct LinearPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3> radiance;  // row 0 on top; finite
};

bool is_pfm(const std::uint8_t* bytes, std::size_t byte_count);
bool is_exr(const std::uint8_t* bytes, std::size_t byte_count);

// Decode a file of either kind, whatever it holds: grey as R = G = B, without alpha. Refuse truncated files, pictures
// of more than `pixel_count_max` pixels, and values that are not finite. `name` is for the error line.
Status decode_pfm(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max,
                  const std::string& name, LinearPicture* picture);
Status decode_linear_exr(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max,
                         const std::string& name, LinearPicture* picture);

// Exposure at which the geometric mean of a picture's lit pixels is middle grey; 1 if none is lit. `--exposure auto`
// measures a scene likewise, from fewer pixels.
double exposure_to_middle_grey(const LinearPicture& picture);

// The factor on `test` that minimises the squared differences from `reference`, both with equal numbers of values; 0 if
// none does.
double aligned_scale(const std::vector<double>& reference, const std::vector<double>& test);

}  // namespace pocketray
