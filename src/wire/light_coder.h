// Maps of indirect light ↔ bytes of a light_map. Channels are quantized to logarithmic levels of about 1/32 octave.
// Levels are predicted from earlier neighbours; differences go through an adaptive range coder. PROTOCOL.md has the
// format. Pure; needs no memory but the map.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

// A level keeps a float's exponent and the first 5 bits of its fraction, rounded: errors up to 1.6 %. Chosen: indirect
// light is less than half of what most pixels show, so this is one display level.
constexpr int kLightLevelShift = 23 - 5;
constexpr std::uint32_t kLightLevelMax = (127u + 64) << 5;  // 2^64

// 0 up to half of the smallest level; the largest level for anything beyond it, infinities and NaN.
std::uint32_t light_level(float value);
float light_of_level(std::uint32_t level);

// Maximum number of columns that can be coded.
constexpr std::uint32_t kLightColumnsMax = 4096;
// Upper bound of encode_light()'s output: uncoded levels of two bytes each, sent where coding is not shorter.
constexpr std::size_t light_bytes_max(std::size_t value_count) { return value_count * 6; }

// Encodes columns × rows lights, none of whose channels is below `faintest`, and replaces them by what the receiver
// gets. Negative lights are "don't care": the receiver gets whatever is shortest. Writes at most light_bytes_max(number
// of lights) to `bytes`; returns the number written.
std::size_t encode_light(Vec3* light, std::uint32_t columns, std::uint32_t rows, float faintest, std::uint8_t* bytes);

// Decodes the lights. Returns false if no encoder wrote these bytes; `light` is then undefined. Otherwise every channel
// is finite and not negative.
[[nodiscard]] bool decode_light(const std::uint8_t* bytes, std::size_t byte_count, std::uint32_t columns,
                                std::uint32_t rows, Vec3* light);

}  // namespace pocketray
