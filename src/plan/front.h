// A front: settings that trade accuracy for time, each with its expected error and its cost per pixel, least accurate
// first.
// As a text file, it has one candidate per line below a line with the version:
//
//   pocketray-front 2
//   samples=4 depth=8 area-lights=16 cut-off=0.5 texture-filter=scene normals=scene indirect=auto
//   reconstruction=bicubic virtual-lights=64 flip=0.0123 flip888=0.0101 ns=812
//
// Names are those of the command line's options; unmeasured errors are omitted. Empty lines and lines that begin with
// # are ignored. Errors of version 1 were relative to the renderer's own lighting model.
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>

#include "base/limits.h"
#include "base/status.h"
#include "effect/setting_list.h"

namespace pocketray {

constexpr std::uint32_t kFrontCandidateMax = 64;          // chosen: four times what builtin_front() has
constexpr float kPriceNsMin = 1e-3f, kPriceNsMax = 1e9f;  // limits of a pixel's price in a file; chosen: a picosecond
                                                          // is beyond any machine, a second beyond any budget
constexpr float kErrorUnknown = std::numeric_limits<float>::quiet_NaN();

struct Candidate : Quality {
  float flip = kErrorUnknown;  // mean ꟻLIP to the truth, in [0, 1], as a screen of 16 bits shows it; NaN: not measured
  float flip888 = kErrorUnknown;  // likewise with 24 bits, as pictures are written
  float ns_per_pixel = 1;         // average over a frame; comparable only with prices measured alongside
};

struct Front {
  Candidate candidates[kFrontCandidateMax];
  std::uint32_t count = 0;
};

// Returns the candidate with this quality, or null.
const Candidate* find_candidate(const Front& front, const Quality& quality);
// Clamps the price to the limits of a file.
float clamped_price(double ns_per_pixel);
Candidate candidate_of(const Quality& quality);
// Returns the settings with this quality.
Settings with_candidate(const Settings& settings, const Quality& quality);

// Returns whether every error of the front was measured; otherwise the order is by accuracy, whatever the prices.
bool errors_known(const Front& front);
// Judges candidates as with 24 bits, where that error is known.
void show_24_bits(Front* front);
void sort_by_price(Front* front);
// If all errors are known, sorts by price and drops candidates that are neither cheaper nor more accurate than another.
void sort_front(Front* front);
// Adopts prices from `measured` for candidates in both fronts; scales the others by the
// mean ratio. Candidates and their order do not change. Returns false and changes
// nothing if the fronts have no candidate in common.
bool adopt_prices(Front* front, const Front& measured);

// Drops the errors, which the scene's front holds, so that no candidate is dominated and every price is kept.
Front prices_alone(const Front& front);

// True if light from other surfaces is a constant or left out in a plan with these effects, though the scene has lights
// that cause it: instant radiosity is nearer to the truth.
bool lacks_indirect_light(EffectMask effects);

// The default front when nothing was measured of a scene whose plan has these effects: from the least to the most that
// a device might do, each candidate at least as accurate as the one before. Prices are guesses.
Front builtin_front(EffectMask effects);
// Drops candidates that make the same picture as another with these effects, such as those that differ in area lights
// where there are none.
void drop_what_scene_ignores(Front* front, EffectMask effects);

// Reads a file's bytes, however malformed: all candidates in file order. Errors name the line; on failure *front is
// empty.
Status parse_front(const void* bytes, std::size_t byte_count, Front* front);

// Upper bound of a written line: "name=value " for each setting, error and price, and the end.
constexpr std::size_t front_line_bytes() {
  constexpr std::size_t kRealBytes = 17;  // with %.9g
  std::size_t bytes = sizeof "flip= flip888= ns=" + 3 * kRealBytes;
  for (const SettingRow& row : kSettingList) {
    std::size_t value = kRealBytes;
    for (int i = 0; i < row.field.name_count; ++i) value = std::max(value, text_length(row.field.names[i]));
    bytes += text_length(row.name) + 2 + value;
  }
  return bytes;
}

// Writes the file into `text`, always terminated; kFrontTextMax bytes hold any front. Returns its length without the
// terminator. parse_front() restores the same bits.
constexpr std::size_t kFrontLineMax = front_line_bytes();
constexpr std::size_t kFrontTextMax = (kFrontCandidateMax + 1) * kFrontLineMax;
std::size_t format_front(const Front& front, char* text, std::size_t size);
// Writes only the quality, as in the file: "samples=4 depth=8 …". Terminated.
void format_quality(const Quality& quality, char* text, std::size_t size);
// Writes the settings that have a display name: "samples 4 depth 8 …". Terminated.
void format_hud_quality(const Quality& quality, char* text, std::size_t size);
// Writes the differences in words: "samples 4 to 1, depth 8 to 2", or "nothing".
void describe_change(const Quality& before, const Quality& after, char* text, std::size_t size);

}  // namespace pocketray
