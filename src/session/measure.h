// Measures the cost of frames, scanlines, rays and effects on this machine.
#pragma once
#include <vector>

#include "engine/renderer.h"

namespace pocketray {

struct MeasuredRange {
  double min = 0, median = 0, max = 0;
};
// Returns the range of the values, and sorts them.
MeasuredRange range_of(double* values, std::uint32_t count);

constexpr std::uint32_t kFrameCountMax = 1000;  // chosen: the times of 240 rows then take 1.9 MB

struct Measurement {
  std::uint32_t frame_count = 0;                                // measured so far
  std::uint32_t frame_count_max;                                // capacity of row_ns
  std::vector<double> ns_per_pixel, pose_ms, refit_ms, row_ns;  // row_ns: frames of row 0, of row 1, …
  Tracer counts;                                                // of the last frame
  bool coherent = false;                // only what may have changed is traced: row times are unknown
  std::uint64_t pixels_traced = 0;      // over all frames
  std::uint32_t whole_frames = 0;       // number of coherent frames that were traced whole after all ...
  const char* whole_because = nullptr;  // ... and the reason for the last of them; null: none
  double trace_ns = 0;                  // over all frames
  double effect_price[kEffectCount];    // ns per pixel; NaN: not measured
};

// Reserves room for `frame_count_max` frames; measuring allocates nothing.
Measurement make_measurement(const Renderer& renderer, std::uint32_t frame_count_max);
// Renders frames from time 0 on, or from the next one if coherence is planned, after one warm-up frame. After an
// interrupt, finished frames remain.
Status measure_frames(Renderer* renderer, Measurement* measurement);
// Prices every effect that is on: the median of frames with it minus the median of frames without it, interleaved.
Status measure_prices(Renderer* renderer, Measurement* measurement);

// Cost per pixel when only some pixels are traced, as after a small change of the picture.
struct SparseCost {
  double fraction = 0;                                       // approximate fraction of the pixels
  MeasuredRange scattered_ns_per_pixel, patch_ns_per_pixel;  // single random pixels; squares of kPatchSide pixels
};
// Chosen: from a small moving object to the whole picture.
constexpr double kSparseFractions[] = {0.02, 0.1, 0.5, 1};
constexpr int kSparseFractionCount = 4;
constexpr std::uint32_t kPatchSide = 20;  // neither a multiple of the tile side nor aligned to tiles

// Returns spans of such pixels in scan order, in patches or scattered. Deterministic for a given size.
std::vector<Span> sparse_spans(const Settings& settings, double fraction, bool patches);
// Traces each kind `round_count` times at time 0, kSparseFractions in turn. An interrupt leaves zeros.
Status measure_sparse(Renderer* renderer, int round_count, SparseCost* costs);

double pixel_count(const Renderer& renderer);
double rays_per_second(const Measurement& measurement);

}  // namespace pocketray
