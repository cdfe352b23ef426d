// What a sweep found: each configuration that was measured, what a frame of it takes and how far it is from the
// reference.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "accuracy/errors.h"
#include "accuracy/statistics.h"

namespace pocketray {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// One configuration. All but one knob of it stand as in the baseline, or several are turned at once.
struct Measured {
  std::string knob;         // its name; "baseline", or "several"
  std::string value;        // "4", "bilinear"; of several: "samples 4, depth 2"
  bool is_default = false;  // the value the baseline has
  // Of a frame after one with the same settings: pose, refit, lights, tracing and packing. The value is the ratio times
  // the baseline's median; the interval holds the configuration's own median, with all that rounds differ by.
  Interval ns_per_pixel;
  Interval time_ratio;  // to the baseline of the same round
  double instructions_per_pixel = kNotMeasured;
  double flip = kNotMeasured;         // mean, as the screen shows it: after quantisation and dither
  double flip_before = kNotMeasured;  // mean, before them
  PictureErrors errors;               // linear light, exposed, cut to what a display shows: [0, 1]
  bool pareto = false;                // no other takes less time with no more ꟻLIP
  std::string missing;                // why there are no figures; empty: there are
  std::string note;                   // what its time is the time of, where that is not this renderer
};

// A knob as a whole. Its configurations are those of `Sweep::measured` with its name, in the order of its values.
struct KnobFigures {
  std::string name;    // "samples"
  std::string what;    // "rays through each pixel"
  std::string effect;  // the effect it belongs to, or "all", "display"
  std::string theory;  // what theory says of the slope, with its number; empty: nothing
  // Of the knob's own RMSE over time, log-log, as fit_power_law() finds it in each round: what no time takes away is
  // owed to the other knobs. The interval is of the times alone; how far errors are from such a law stands beside it.
  Interval slope;
  double slope_misfit = 0;
  bool has_slope = false;
  double ms_per_flip = kNotMeasured;  // ms a frame that 0.01 of ꟻLIP costs, from the knob's worst end to its best
};

// A picture as 8-bit levels R, G, B, row 0 on top.
struct Levels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// What a strip shows of one configuration.
struct StripRow {
  std::string label;  // "samples 4"
  double ms = 0;      // a frame
  double flip = 0;
  Levels picture;
  std::vector<float> flip_map;  // the error of each pixel, in [0, 1]
};
struct Strip {
  std::string knob;
  std::vector<StripRow> rows;  // a few values, the least accurate first
};

struct Sweep {
  std::string scene, machine;  // "cornell"; "2 threads, avx512"
  std::uint32_t width = 0, height = 0;
  std::uint32_t rounds = 0;  // times that each configuration was timed
  double pixels_per_degree = 0;
  std::string reference;                          // "model": the lighting model at its limit; "physical": all transport
  std::uint32_t reference_samples = 0;            // a pixel, both seeds together
  double reference_rmse = 0, reference_flip = 0;  // what the reference itself may err by
  double model_flip = kNotMeasured, model_rmse = kNotMeasured;  // of the model's limit against all transport
  double model_flip_error = 0;                                  // what both references may err by in that
  std::string output;                                           // of the baseline: "rgb565 dithered"
  Levels reference_picture;
  std::vector<Measured> measured;  // the baseline first
  std::vector<KnobFigures> knobs;
  std::vector<Strip> strips;
  std::vector<std::string> notes;  // a line each: knobs that were left out and why, …
};

// No comparison finer than this many times the reference's own error is claimed.
constexpr double kClaimFactor = 10;

}  // namespace pocketray
