// Cost of rendering.
#pragma once
#include <ctime>

#include "engine/renderer.h"

namespace pocketray {

struct RenderCost {
  std::uint64_t rays = 0;  // of all kinds through the whole scene, including shadow rays that look for changes
  double ms = 0;           // from posing the scene to the last pixel
  double cpu_ms = 0;       // of all threads
};

inline void add(const RenderCost& cost, RenderCost* sum) {
  sum->rays += cost.rays, sum->ms += cost.ms, sum->cpu_ms += cost.cpu_ms;
}

// Rays of the last frame.
inline std::uint64_t ray_count(const Renderer& renderer) {
  const Tracer counts = total_counts(renderer);
  std::uint64_t rays = 0;
  for (std::uint64_t count : counts.rays) rays += count;
  return rays;
}

struct Stopwatch {
  std::uint64_t start_ns = clock_ns();
  std::clock_t start_cpu = std::clock();
};
inline void stop(const Stopwatch& watch, RenderCost* cost) {
  cost->ms = static_cast<double>(clock_ns() - watch.start_ns) * 1e-6;
  cost->cpu_ms = static_cast<double>(std::clock() - watch.start_cpu) * 1e3 / CLOCKS_PER_SEC;
}

inline double seconds_of(const Renderer& renderer, std::uint32_t frame) {
  return frame / static_cast<double>(renderer.scene.info.frames_per_second);
}

}  // namespace pocketray
