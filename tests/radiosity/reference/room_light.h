// Indirect light of rooms against full light transport, by regions of the picture.
#pragma once
#include <memory>
#include <vector>

#include "support/generated_scene.h"

namespace pocketray {

constexpr std::uint32_t kRegionSide = 8;  // pixels

// Indirect light that matte surfaces reflect, by regions: squares of pixels.
struct RoomLight {
  std::uint32_t columns = 0, rows = 0;
  std::vector<double> sum;    // of a region's matte pixels
  std::vector<double> error;  // standard error of the sum; empty if it was not sampled
  // Sums by either half of the samples; their mean is `sum`. What one half chooses, the other measures without bias.
  std::vector<double> half[2];
};

// Full light transport: the physical reference, followed along random directions from each pixel's first hit. Either
// half takes `directions` of them, a square number, in each round; regions take part in at most `rounds_max` rounds,
// until their standard error is `noise_max` of their light.
struct TruthOptions {
  std::uint32_t directions = 64, rounds_max = 1;
  double noise_max = .007;
};
RoomLight true_light(const Scene& scene, const Settings& settings, const TruthOptions& options);
// The difference that `settings.indirect` makes.
RoomLight rendered_light(const Scene& scene, const Settings& settings);

// A region counts if it has this share of the mean light.
constexpr double kRegionCounts = .25;

// Over the regions that count. The signs of errors, and the worst one, are chosen by one half of the truth and measured
// by the other, so that noise adds nothing.
struct RoomErrors {
  double mean = 0;         // absolute
  double worst = 0;        // signed
  double total = 0;        // signed, of all light
  double noise = 0;        // of the truth: mean standard error
  std::size_t region = 0;  // with the worst error
  double worst_noise = 0;  // of the truth there
};
RoomErrors compare_light(const RoomLight& found, const RoomLight& truth);

// Light that radiosity stores; `patch_count` as in RadiosityOptions. `cost` is what storing it took, or null.
struct StoredCost {
  std::uint32_t patches = 0;
  std::size_t bytes = 0;
  double seconds = 0;  // of CPU time
};
RoomLight stored_light(Scene scene, Settings settings, std::uint32_t patch_count, std::uint32_t threads,
                       StoredCost* cost = nullptr);
RoomLight instant_light(const Scene& scene, Settings settings, std::uint32_t light_count);

// Rooms with boxes, plates, and one- and two-sided lamps near to and far from walls, or point lights in niches.
std::unique_ptr<GeneratedScene> random_room(std::uint64_t seed);
// A room with a lamp at a share of its height below the ceiling (HARDCASES row 71).
std::unique_ptr<GeneratedScene> room_with_lamp(float gap, bool two_sided);
// A room that a plate divides, with a lamp on one side, seen from either.
std::unique_ptr<GeneratedScene> divided_room(float at, bool dark_side);

Settings room_settings(std::uint32_t width, std::uint32_t height);

}  // namespace pocketray
