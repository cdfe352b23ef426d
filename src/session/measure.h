// What frames, scanlines, rays and effects cost on this machine.
#pragma once
#include <vector>

#include "engine/renderer.h"

namespace pocketray {

struct Range {
  double min = 0, median = 0, max = 0;
};
// Sorts the values.
Range range_of(double* values, std::uint32_t count);

constexpr std::uint32_t kFrameCountMax = 1000;

struct Measurement {
  std::uint32_t frame_count = 0;                                // measured so far
  std::uint32_t frame_count_max;                                // row_ns has room for
  std::vector<double> ns_per_pixel, pose_ms, refit_ms, row_ns;  // row_ns: frames of row 0, of row 1, …
  Tracer counts;                                                // of the last frame
  double trace_ns = 0;                                          // of all frames
  double effect_price[kEffectCount];                            // ns per pixel; NaN: not measured
};

// Room for so many frames; nothing allocates afterwards.
Measurement make_measurement(const Renderer& renderer, std::uint32_t frame_count_max);
// Renders frames from time 0 on, after one to warm up. An interrupt keeps what was measured.
Status measure_frames(Renderer* renderer, Measurement* measurement);
// The price of every effect that is on: the median of frames with it minus the median of frames without it, in turn.
Status measure_prices(Renderer* renderer, Measurement* measurement);

// What a pixel costs where only some are traced, as after a small change of the picture.
struct SparseCost {
  double fraction = 0;                               // of the pixels, about
  Range scattered_ns_per_pixel, patch_ns_per_pixel;  // each by itself at random; in squares of kPatchSide pixels
};
constexpr double kSparseFractions[] = {0.02, 0.1, 0.5, 1};
constexpr int kSparseFractionCount = 4;
constexpr std::uint32_t kPatchSide = 20;  // no multiple of a tile's, nor are they aligned to tiles

// The spans of such pixels, from the top, left to right; `patches` or scattered. The same ones for the same size.
std::vector<Span> sparse_spans(const Settings& settings, double fraction, bool patches);
// Traces them `round_count` times each at time 0, kSparseFractions in turn. An interrupt leaves zeros.
Status measure_sparse(Renderer* renderer, int round_count, SparseCost* costs);

double pixel_count(const Renderer& renderer);
double rays_per_second(const Measurement& measurement);

}  // namespace pocketray
