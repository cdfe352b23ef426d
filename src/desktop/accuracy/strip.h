// Strips that show settings beside the reference.
#pragma once
#include <array>
#include <string>

#include "base/status.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

constexpr int kDifferenceGain = 8;

// The colour of an error in [0, 1], from black through violet and orange to light yellow: the map "magma", as in the
// pictures of [Andersson20], interpolated linearly between its tenths.
std::array<std::uint8_t, 3> flip_color(float error);

// Layout of a strip, in its pixels. Panels from the left: reference, setting, difference, error map.
struct StripLayout {
  int zoom = 1;  // strip pixels per picture pixel: small pictures are magnified
  int width = 0, height = 0;
  int panel_column[4] = {}, text_column = 0;
  int first_row = 0, row_step = 0;  // top of the first row's panels; distance between rows
};
StripLayout strip_layout(const Levels& reference, const Strip& strip);

// One row per configuration: reference | setting | difference × kDifferenceGain | error map | time and error as text.
// All pictures must have the reference's size.
Levels draw_strip(const Levels& reference, const Strip& strip);

// Encodes a picture as PNG.
Status encode_png(const Levels& picture, std::string* bytes);

}  // namespace pocketray
