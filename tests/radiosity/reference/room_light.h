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
};

// By `direction_count` directions, a square number, from each pixel's first hit, along which the physical reference is
// followed.
RoomLight true_light(const Scene& scene, const Settings& settings, std::uint32_t direction_count);
// The difference that `settings.indirect` makes.
RoomLight rendered_light(const Scene& scene, const Settings& settings);

// Over the regions that have at least a quarter of the mean light.
struct RoomErrors {
  double mean = 0;         // absolute
  double worst = 0;        // signed
  double total = 0;        // signed, of all light
  double noise = 0;        // of the truth: mean standard error
  std::size_t region = 0;  // with the worst error
  double worst_noise = 0;  // of the truth there
};
RoomErrors compare_light(const RoomLight& found, const RoomLight& truth);

// Light that radiosity stores; `patch_count` as in RadiosityOptions.
RoomLight stored_light(Scene scene, Settings settings, std::uint32_t patch_count, std::uint32_t threads);
RoomLight instant_light(const Scene& scene, Settings settings, std::uint32_t light_count);

// Rooms with boxes, plates, and one- and two-sided lamps near to and far from walls, or point lights in niches.
std::unique_ptr<GeneratedScene> random_room(std::uint64_t seed);
// A room with a lamp at a share of its height below the ceiling (HARDCASES row 71).
std::unique_ptr<GeneratedScene> room_with_lamp(float gap, bool two_sided);
// A room that a plate divides, with a lamp on one side, seen from either.
std::unique_ptr<GeneratedScene> divided_room(float at, bool dark_side);

Settings room_settings(std::uint32_t width, std::uint32_t height);

}  // namespace pocketray
