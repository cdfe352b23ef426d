// The result of a sweep: frame time and error of each configuration.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "desktop/accuracy/errors.h"
#include "desktop/accuracy/statistics.h"

namespace pocketray {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// A reference to judge pictures by: full light transport, or the renderer's own lighting model, converged. Numerical
// settings (samples, points, cut-off, filters) are judged by the model, which contains no other error; what a user sees
// is judged by the truth.
enum class Judge { truth, model };
constexpr const char* kJudgeNames[] = {"physical", "model"};
constexpr const char* kJudgeTexts[] = {"full light transport", "the converged lighting model"};
inline const char* name_of(Judge judge) { return kJudgeNames[static_cast<int>(judge)]; }
inline const char* text_of(Judge judge) { return kJudgeTexts[static_cast<int>(judge)]; }
inline Judge other_than(Judge judge) { return judge == Judge::truth ? Judge::model : Judge::truth; }

// ꟻLIP between a picture and one reference.
struct Distance {
  double flip = kNotMeasured;  // mean, without what the reference's noise adds
  // Mean of each block of the picture against the reference's independent halves; empty: not known.
  std::vector<float> one, other;
};

// Output to a screen: a pixel format, dithered or not; knob_list.h names them.
constexpr int kOutputFormatCount = 3;

// One configuration: the baseline with one knob changed, or several.
struct Measured {
  std::string knob;         // its name; "baseline", or "several"
  std::string value;        // "4", "bilinear"; for several: "samples 4, depth 2"
  bool is_default = false;  // the baseline's value
  // Frame time after a frame with equal settings: pose, refit, lights, tracing and packing. The value is the ratio
  // times the baseline's median; the interval is that of the configuration's own median and includes variation between
  // rounds.
  Interval ns_per_pixel;
  Interval time_ratio;  // relative to the baseline of the same round
  double instructions_per_pixel = kNotMeasured;
  double bytes_per_frame = kNotMeasured;  // of its rows from a render server; only for the baseline and near-lossless
  // Bytes of the .pray file, which a device loads as it is, and the time to bake it; known for the baseline and for
  // choices of `bake`.
  double stored_bytes = kNotMeasured, bake_seconds = kNotMeasured;
  Distance truth, model;              // as shown on screen: after quantisation and dither
  double flip_before = kNotMeasured;  // mean against the model, before these
  // Against the truth, as each output format shows it.
  std::array<double, kOutputFormatCount> flip_as = {kNotMeasured, kNotMeasured, kNotMeasured};
  PictureErrors errors;   // against the model: exposed linear light, clamped to the display range [0, 1]
  std::string indirect;   // method of indirect light, "none" without one; empty: unknown
  bool is_choice = true;  // can be chosen between frames on the baseline's screen
  bool pareto = false;    // a choice, and no other is as fast and claimed to be nearer to the judge
  std::string missing;    // why there are no figures; empty: there are
  std::string note;       // says what was timed, if not this renderer
};

// Summary of a knob. Its configurations are those in `Sweep::measured` with its name, in the order of its values.
struct KnobFigures {
  std::string name;            // "samples"
  std::string what;            // "rays through each pixel"
  std::string effect;          // the effect it belongs to, or "all", "display"
  std::string theory;          // theoretical slope, with its number; empty: none
  Judge judge = Judge::model;  // of its values: methods of indirect light by the truth, numerical settings by the model
  // Slope of the knob's own RMSE over time, log-log, from fit_power_law() in each round; error that time does not
  // reduce comes from the other knobs. The interval covers only the times; slope_misfit is how far errors deviate from
  // the law.
  Interval slope;
  double slope_misfit = 0;
  bool has_slope = false;
  bool is_baked = false;              // a choice of `bake`
  double ms_per_flip = kNotMeasured;  // ms per frame for 0.01 of ꟻLIP, from the knob's worst end to its best
};

// A picture as 8-bit levels R, G, B, row 0 on top.
struct Levels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// One configuration in a strip.
struct StripRow {
  std::string label;  // "samples 4"
  double ms = 0;      // per frame
  double flip = 0;
  Levels picture;
  std::vector<float> flip_map;  // error of each pixel, in [0, 1]
  double bytes = kNotMeasured;  // of a frame's rows, shown in place of the time if the knob costs bytes
};
struct Strip {
  std::string knob;
  std::vector<StripRow> rows;  // a few values, least accurate first
};

// A level of quality: its options, and the picture, time and error that they give.
struct LevelPicture {
  std::string level, settings;  // "high"; as options: "--samples 4 --area-lights 16", empty: the defaults
  double ms = 0;                // per frame
  double flip = 0;              // to the truth, as pictures are written
  Levels picture;
  std::size_t measured_index = 0;  // of its figures in Sweep::measured
};

// A reference's samples per pixel, both seeds together, and its own error.
struct ReferenceFigures {
  std::uint32_t samples = 0;
  double rmse = 0, flip = 0;
};

// Prediction of time, bytes and error of `bake --radiosity`.
struct RadiosityPrediction {
  std::string why_not;                 // why it would give nothing; empty: see below
  double seconds = 0;                  // of the bake, on this machine
  double bytes = 0;                    // added to the .pray file
  double ns_per_pixel = 0;             // of frames
  double flip = kNotMeasured;          // to the truth, from a solution of few patches
  double flip_without = kNotMeasured;  // the baseline's
};

struct Sweep {
  std::string scene, machine;  // "cornell"; "2 threads, avx512"
  std::uint32_t width = 0, height = 0;
  std::uint32_t rounds = 0;  // number of times that each configuration was timed
  double pixels_per_degree = 0;
  Judge judge = Judge::truth;  // of the front
  ReferenceFigures truth, model;
  double model_distance = kNotMeasured, model_rmse = kNotMeasured;  // converged model against full transport
  std::string output;                                               // the baseline's: "rgb565 dithered"
  Levels reference_picture, truth_picture;                          // the model, and full transport
  std::vector<Measured> measured;                                   // the baseline first
  std::vector<KnobFigures> knobs;
  std::vector<Strip> strips;
  std::vector<LevelPicture> quality;  // by level, the least accurate first; empty: there is no front
  RadiosityPrediction radiosity;
  std::vector<std::string> notes;  // one line each: skipped knobs and why, …
};

// An RMSE below this many times the reference's own is not claimed.
constexpr double kClaimFactor = 10;

// Pictures whose rows a render server sends: the camera orbits its target by kSentOrbitDegrees per frame, and the last
// of kSentFrames is judged. Its rows are predicted from the previous frame, as almost all are. Chosen: the path of
// split-report.
constexpr double kSentOrbitDegrees = 1;
constexpr std::uint32_t kSentFrames = 8;

}  // namespace pocketray
