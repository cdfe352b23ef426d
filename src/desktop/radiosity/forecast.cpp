// Predicts what a solution costs: its parts are few kinds of like work, of which a sample is timed.
#include <algorithm>
#include <chrono>

#include "base/check.h"
#include "desktop/radiosity/receivers.h"
#include "desktop/radiosity/store_light.h"

namespace pocketray {
namespace {

// Chosen: half a second for cornell.
constexpr std::uint32_t kRowSamples = 96, kReceiverSamples = 512;
// Making factors consistent and shooting, for each pair of patches. Measured: .12 to .22 µs in 16 scenes on a core of
// 2.8 GHz, a seventh of all at most.
constexpr double kSettlePairSeconds = 0.16e-6;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Time of work(i) for every i below count, from a sample spread evenly over them.
template <class Work>
double sampled_seconds(std::uint32_t count, std::uint32_t sample_count, std::uint32_t threads, const Work& work) {
  const std::uint32_t samples = std::min(count, sample_count);
  if (samples == 0) return 0;
  const auto start = std::chrono::steady_clock::now();
  parallel_for(samples, threads, [&](std::uint32_t k) {
    work(static_cast<std::uint32_t>((2 * std::uint64_t(k) + 1) * count / (2 * samples)));
  });
  return seconds_since(start) * count / samples;
}

struct Placed {
  Places places;
  RadiositySize size;
};

// Places what solve_radiosity() would store.
Placed place(const RadiosityOptions& options, const PatchSolution& solved) {
  const Scene& scene = *solved.rays.frame.scene;
  std::vector<char> front(scene.triangles.count, 1), back(scene.triangles.count, 0);
  for (const Patch& patch : solved.patches)
    if (patch.is_back)
      for (std::uint32_t t : patch.triangles) back[t] = 1;
  RadiositySolution stored;
  Placed placed;
  placed.places = place_receivers(scene, solved.surfaces, options, front, back, &stored);
  placed.size.patch_count = static_cast<std::uint32_t>(solved.patches.size());
  placed.size.receiver_count = static_cast<std::uint32_t>(placed.places.nodes.size() + placed.places.values.size());
  placed.size.bytes = stored.bytes() + sizeof(RadiosityInfo);
  return placed;
}

}  // namespace

std::size_t radiosity_bytes_of_fronts(const Scene& scene, const RadiosityOptions& options) {
  const Surfaces surfaces = find_surfaces(scene, options.patch_count);
  if (!(surfaces.total_area > 0)) return 0;
  RadiositySolution solution;
  const std::vector<char> front(scene.triangles.count, 1), back(scene.triangles.count, 0);
  place_receivers(scene, surfaces, options, front, back, &solution);
  return solution.bytes() + sizeof(RadiosityInfo);
}

Status size_radiosity(const FrameData& frame, const RadiosityOptions& options, RadiositySize* size) {
  CHECK(frame.scene != nullptr && frame.geometry.accel_info != nullptr && size != nullptr);
  PatchSolution solved(frame);
  RETURN_IF_ERROR(divide_surfaces(options, &solved));
  *size = place(options, solved).size;
  return success();
}

Status forecast_radiosity(const FrameData& frame, const RadiosityOptions& options, RadiosityForecast* forecast) {
  CHECK(frame.scene != nullptr && frame.geometry.accel_info != nullptr && forecast != nullptr);
  *forecast = RadiosityForecast();
  const auto start = std::chrono::steady_clock::now();
  PatchSolution solved(frame);
  RETURN_IF_ERROR(divide_surfaces(options, &solved));
  const Placed placed = place(options, solved);
  const Places& places = placed.places;
  const std::uint32_t patch_count = placed.size.patch_count;
  double seconds = seconds_since(start);
  seconds += sampled_seconds(patch_count, kRowSamples, options.threads, [&](std::uint32_t i) {
    std::vector<float> row(patch_count), there(solved.rays.has_sheets ? patch_count : 0);
    find_factor_row(solved.rays, solved.patches, i, row.data(), there.empty() ? nullptr : there.data());
  });
  seconds += kSettlePairSeconds * patch_count * patch_count;
  const std::vector<Vec3d> dark(patch_count, Vec3d{0, 0, 0});
  const PatchLight light = {solved.patches, dark, dark};
  const std::uint32_t node_count = static_cast<std::uint32_t>(places.nodes.size());
  seconds += sampled_seconds(placed.size.receiver_count, kReceiverSamples, options.threads, [&](std::uint32_t i) {
    if (i < node_count)
      gather(solved.rays, light, places.nodes[i].at, places.nodes[i].material, true, i);
    else
      gather(solved.rays, light, places.values[i - node_count].at, places.values[i - node_count].material, false, i);
  });
  forecast->size = placed.size;
  forecast->seconds = seconds;
  return success();
}

}  // namespace pocketray
