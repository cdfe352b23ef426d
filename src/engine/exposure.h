// Measuring a scene's exposure in parts, for who has other things to do meanwhile.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// build_renderer() but for an exposure that is to be measured (wants_exposure()): the caller's to probe.
Status build_renderer_unexposed(Renderer* renderer);
bool wants_exposure(const Renderer& renderer);

struct ExposureProbe {
  std::uint32_t next = 0, lit = 0;  // of the grid's pixels: the next one, and how many were bright
  double log_sum = 0;
};
// What measure_exposure() measures, from the next pixels of the grid: `pixel_count_max` at most, *pixel_count of them.
// True: it was the last one, and *exposure is measured.
bool probe_exposure(Renderer* renderer, ExposureProbe* probe, std::uint32_t pixel_count_max, std::uint32_t* pixel_count,
                    float* exposure);

}  // namespace pocketray
