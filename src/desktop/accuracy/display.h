// Converts radiance to displayed values, for comparing pictures as the eye sees them.
#pragma once
#include "desktop/accuracy/knob_list.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

// Light that a display shows of a radiance, within [0, 1]; NaN becomes 0.
Vec3d displayed_light(const Vec3& radiance, double exposure, Tone tone);

// R, G, B of each pixel in displayed linear light.
std::vector<double> displayed_light(const Vec3* radiance, std::size_t pixel_count, const Display& display);

// Converts light to sRGB, as input for FLIP, without quantisation.
std::vector<float> encoded_light(const std::vector<double>& light);

// Unpadded rows of pixels as sent to the screen; not rotated. Aligned for whole pixels.
std::vector<std::uint8_t> packed_pixels(const Vec3* radiance, std::uint32_t width, std::uint32_t height,
                                        const Display& display, const OutputFormat& output);
// Unpadded rows of pixels as the screen shows them.
Levels unpacked_levels(const std::uint8_t* pixels, std::uint32_t width, std::uint32_t height,
                       const PixelFormat& format);
// Radiance as the screen shows it, quantised to the pixel format: packed_pixels(), then unpacked_levels().
Levels displayed_levels(const Vec3* radiance, std::uint32_t width, std::uint32_t height, const Display& display,
                        const OutputFormat& output);
// Levels as sRGB in [0, 1].
std::vector<float> encoded_levels(const Levels& levels);

// Mean of the errors of all pixels.
double mean_of(const std::vector<float>& errors);

}  // namespace pocketray
