// ꟻLIP: how different two pictures look when flipping between them at a viewing distance [Andersson20: Andersson et
// al., FLIP: A Difference Evaluator for Alternating Images, HPG 2020]. Desktop only.
#pragma once
#include <cstddef>
#include <vector>

namespace pocketray {

// Pixels per degree of a 3.5" screen of 320 × 240 pixels seen from 30 cm: 71.1 mm wide, 4.5 pixels per millimetre.
constexpr double kHandheldPixelsPerDegree = 23.6;

// Returns the error of each of width × height pixels, in [0, 1]. `reference` and `test` hold R, G, B of each pixel in
// [0, 1], encoded as sRGB, row 0 on top.
std::vector<float> flip_errors(const std::vector<float>& reference, const std::vector<float>& test, std::size_t width,
                               std::size_t height, double pixels_per_degree);

}  // namespace pocketray
