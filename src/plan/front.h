// A front: settings that trade accuracy for time, each with the error to expect and what a pixel takes, the least
// accurate first.
// And as a text file, one candidate a line under a line with the version:
//
//   pocketray-front 1
//   samples=4 depth=8 area-lights=16 cut-off=0.5 texture-filter=scene normals=scene flip=0.0123 ns=812
//
// The names are those of the command line's options; an error that was not measured is left out. Lines that are empty
// or begin with # mean nothing.
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>

#include "base/limits.h"
#include "base/status.h"
#include "effect/setting_list.h"

namespace pocketray {

constexpr std::uint32_t kFrontCandidateMax = 64;
constexpr float kPriceNsMin = 1e-3f, kPriceNsMax = 1e9f;  // of a pixel, as a file may state it
constexpr float kErrorUnknown = std::numeric_limits<float>::quiet_NaN();

struct Candidate : Quality {
  float flip = kErrorUnknown;  // mean ꟻLIP of the picture, in [0, 1]; NaN: not measured
  float ns_per_pixel = 1;      // of a whole frame; to be compared with each other where measured elsewhere
};

struct Front {
  Candidate candidates[kFrontCandidateMax];
  std::uint32_t count = 0;
};

// The candidate of the same quality; null where there is none.
const Candidate* find_candidate(const Front& front, const Quality& quality);
// As a file may state it.
float clamped_price(double ns_per_pixel);
Candidate candidate_of(const Quality& quality);
// The settings with that quality.
Settings with_candidate(const Settings& settings, const Quality& quality);

// Whether every error of the front was measured. Where one was not, the order is that of accuracy, whatever the prices.
bool errors_known(const Front& front);
void sort_by_price(Front* front);
// Where all errors are known: sorts by price, leaves out what takes no less than another and is no more accurate.
void sort_front(Front* front);
// Takes the prices of candidates that `measured` has, too; those of others follow by the mean ratio of these.
// Candidates and their order stay. False, and nothing changes, where there are none in common.
bool adopt_prices(Front* front, const Front& measured);

// What to choose from where nothing was measured: from the least to the most that a device may want to do, each
// candidate at least as accurate as the one before. Prices are guesses.
Front builtin_front();
// Leaves out what makes no other picture, given the effects that are on: area lights where there are none, and so on.
void drop_what_scene_ignores(Front* front, EffectMask effects);

// Reads a file's bytes, whatever they are: all candidates, as they stand; an error names the line. On failure *front is
// empty.
Status parse_front(const void* bytes, std::size_t byte_count, Front* front);

// The longest line that is written: "name=value " for each setting, error and price, and the end.
constexpr std::size_t front_line_bytes() {
  constexpr std::size_t kRealBytes = 17;  // with %.9g
  std::size_t bytes = sizeof "flip= ns=" + 2 * kRealBytes;
  for (const SettingRow& row : kSettingList) {
    std::size_t value = kRealBytes;
    for (int i = 0; i < row.field.name_count; ++i) value = std::max(value, text_length(row.field.names[i]));
    bytes += text_length(row.name) + 2 + value;
  }
  return bytes;
}

// Writes the file into `text`, always terminated; kFrontTextMax bytes hold any. Returns its length without the
// terminator. What it writes, parse_front() reads with the same bits.
constexpr std::size_t kFrontLineMax = front_line_bytes() > 192 ? front_line_bytes() : 192;
constexpr std::size_t kFrontTextMax = (kFrontCandidateMax + 1) * kFrontLineMax;
std::size_t format_front(const Front& front, char* text, std::size_t size);
// The quality alone, as in the file: "samples=4 depth=8 …". Terminated.
void format_quality(const Quality& quality, char* text, std::size_t size);
// Those that have a name for the display: "samples 4 depth 8 …". Terminated.
void format_hud_quality(const Quality& quality, char* text, std::size_t size);
// What differs from `before`, as people say it: "samples 4 to 1, depth 8 to 2"; "nothing" where nothing does.
void describe_change(const Quality& before, const Quality& after, char* text, std::size_t size);

}  // namespace pocketray
