// Maps of indirect light ↔ bytes of a light_map. Channels travel as levels, even in ratio: a 32nd of an octave or so.
// Levels are predicted from the neighbours before; what differs goes through an adaptive range coder. PROTOCOL.md has
// the format. Pure; needs no memory but the map.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

// Of a float's bits, a level has those of the exponent and the first of the fraction, rounded: errors of 1.6 % at most.
// Chosen: of indirect light, which is less than half of what most pixels show, that is one display level.
constexpr int kLightLevelShift = 23 - 5;
constexpr std::uint32_t kLightLevelMax = (127u + 64) << 5;  // 2^64

// 0 up to a half of the smallest; the largest for what exceeds that, is infinite or no number.
std::uint32_t light_level(float value);
float light_of_level(std::uint32_t level);

// More columns cannot be coded.
constexpr std::uint32_t kLightColumnsMax = 4096;
// Bytes that encode_light() never exceeds: levels of two bytes each, as they are, if coding does not make them shorter.
constexpr std::size_t light_bytes_max(std::size_t value_count) { return value_count * 6; }

// Encodes columns × rows lights, none of whose channels is below `faintest`, and replaces them by what the receiver
// gets. Negative ones are free: the receiver gets whatever is shortest. Writes at most light_bytes_max() of their
// number to `bytes`; returns how many.
std::size_t encode_light(Vec3* light, std::uint32_t columns, std::uint32_t rows, float faintest, std::uint8_t* bytes);

// Decodes them. False: no encoder wrote these bytes, and `light` is undefined. Otherwise every channel is finite and
// not negative.
[[nodiscard]] bool decode_light(const std::uint8_t* bytes, std::size_t byte_count, std::uint32_t columns,
                                std::uint32_t rows, Vec3* light);

}  // namespace pocketray
