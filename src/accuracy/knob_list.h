// The knobs: each row of effect/setting_list.h and what else trades accuracy for time. A sweep turns every one of them
// that the scene has a use for; a new row is swept, priced and drawn without further code.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "effect/effect_plan.h"
#include "effect/settings.h"
#include "present/pack.h"
#include "scene/builtin/builtin.h"

namespace pocketray {

// What a screen shows: pixels of a format, dithered or not.
struct OutputFormat {
  const char* name;
  PixelFormat format;
  bool dither;
};
constexpr OutputFormat kOutputFormats[] = {
    {"rgb565", kRgb565, false}, {"rgb565-dithered", kRgb565, true}, {"rgb888", kRgb888, false}};
constexpr int kOutputFormatCount = 3;
// The index of a format of that name, or -1.
int find_output_format(const std::string& name);

// Everything a knob can turn.
struct Configuration {
  Settings settings;
  bool double_precision = false;                         // every number of the tracing
  int output = 1;                                        // of kOutputFormats: the handheld's
  std::uint32_t sphere_columns = kCornellSphereColumns;  // of cornell
};

struct Knob {
  const char* name = nullptr;       // "samples"
  const char* what = nullptr;       // "rays through each pixel"
  std::string effect;               // it belongs to, as people read it
  EffectMask needs = 0;             // it turns something where any of these effects is on; 0: always
  const char* scene = nullptr;      // the only built-in scene that has it; null: every one
  const char* theory = nullptr;     // of the slope of RMSE over time; empty: theory gives no number
  std::vector<double> values;       // the least accurate first
  std::vector<const char*> labels;  // one for each value; empty: the numbers themselves
  std::function<double(const Configuration& configuration)> get;
  std::function<void(Configuration* configuration, double value)> set;
  double (*price)(double value) =
      nullptr;             // what a frame takes, roughly, up to a factor; null: the value matters little
  bool alone = false;      // it is not turned together with others
  bool is_setting = true;  // one can choose it from frame to frame
};

const std::vector<Knob>& knob_list();

// "4", or the value's label.
std::string value_label(const Knob& knob, double value);
// The knob's values and, where it is none of them, the baseline's, in order.
std::vector<double> knob_values(const Knob& knob, const Configuration& baseline);
// Whether the knob turns anything in a scene of that name and plan. If not, *why says so.
bool knob_applies(const Knob& knob, const std::string& scene, const EffectPlan& plan, std::string* why);
// What a frame with `value` takes, in frames of the baseline, roughly: for leaving out what would take too long.
double relative_price(const Knob& knob, const Configuration& baseline, double value);

}  // namespace pocketray
