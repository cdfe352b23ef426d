// Samples added to the pixels at edges. Each pixel's centre is traced; where the displayed value bends from one
// neighbour over the pixel to the opposite one, the pixel gets more samples, and takes the mean of all. A gradient does
// not bend, and a boundary between surfaces of one colour is no edge.
//
// A pixel depends only on the centres of the 3 × 3 pixels around it and on its own samples: these are traced whichever
// pixels are requested, so that the picture does not depend on how it is divided.
#pragma once
#include "shade/lattice.h"
#include "shade/shared_pixels.h"
#include "shade/window.h"

namespace pocketray {

// True if memory is planned for samples at edges.
constexpr bool plans_edges(const Settings& settings) {
  return settings.edge_samples > 0 && !(settings.forced_off & bit(Effect::edge_sampling));
}
constexpr bool plans_window(const Settings& settings) { return plans_lattice(settings) || plans_edges(settings); }
constexpr bool keeps_shared_pixels(const Settings& settings, EffectMask mask) {
  return plans_edges(settings) && is_interleaved(mask);
}
inline std::size_t window_need(const Settings& settings, EffectMask mask) {
  if (!plans_window(settings)) return 0;
  const std::size_t count = std::size_t(settings.threads) * window_pixel_count(settings);
  return arena_need<Vec3>(count) + arena_need<std::uint8_t>(count) +
         (keeps_shared_pixels(settings, mask) ? arena_need<SharedPixel>(count) : 0);
}

// Samples of a pixel of which first hits are kept (KeptRays): each pixel's own, then those at edges. Pixels elsewhere
// have kNotTraced as the triangle of the first of these.
constexpr std::uint32_t kNotTraced = kNoTriangle - 1;
inline std::uint32_t kept_sample_count(const Settings& settings, EffectMask mask) {
  return settings.samples_per_pixel + (has(mask, Effect::edge_sampling) ? settings.edge_samples : 0);
}
Vec2 kept_sample_offset(const Settings& settings, std::uint32_t sample);
// Returns whether the pixel has the samples added at edges.
inline bool is_edge(const Settings& settings, const Hit* first_hits, std::uint32_t column, std::uint32_t row) {
  const std::size_t line = std::size_t(settings.samples_per_pixel) * settings.height + row;
  return first_hits[line * settings.width + column].triangle != kNotTraced;
}

// Traces the strip's pixels.
void trace_edges(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

}  // namespace pocketray
