// Measures a scene's exposure in steps, for callers that have other work to do in between.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// build_renderer() without measuring exposure: if wants_exposure(), the caller must probe it.
Status build_renderer_unexposed(Renderer* renderer);
bool wants_exposure(const Renderer& renderer);

struct ExposureProbe {
  std::uint32_t next = 0, lit = 0;  // next pixel of the grid; number of bright pixels so far
  double log_sum = 0;
};
// measure_exposure() in steps: traces the next pixels of the grid, at most `pixel_count_max`, and sets *pixel_count to
// their number. Returns true after the last one, with *exposure set.
bool probe_exposure(Renderer* renderer, ExposureProbe* probe, std::uint32_t pixel_count_max, std::uint32_t* pixel_count,
                    float* exposure);

}  // namespace pocketray
