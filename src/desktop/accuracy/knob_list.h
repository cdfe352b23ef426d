// The knobs: every row of effect/setting_list.h, and everything else that trades accuracy for time. A sweep varies each
// knob that affects the scene; a new row is swept, priced and plotted without further code.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "desktop/accuracy/result.h"
#include "effect/effect_plan.h"
#include "effect/settings.h"
#include "present/pack.h"
#include "scene/builtin/builtin.h"
#include "scene/texture_side.h"

namespace pocketray {

struct OutputFormat {
  const char* name;
  PixelFormat format;
  bool dither;
};
constexpr OutputFormat kOutputFormats[] = {
    {"rgb565", kRgb565, false}, {"rgb565-dithered", kRgb565, true}, {"rgb888", kRgb888, false}};
static_assert(sizeof kOutputFormats / sizeof kOutputFormats[0] == kOutputFormatCount, "a figure for each");
// Index of the format with that name, or -1.
int find_output_format(const std::string& name);

// How `bake` stores a scene, where a sweep varies it.
struct BakeChoices {
  std::uint32_t texture_side_max = kTextureSideUsual;
  bool has_mip_maps = true, is_compressed = false;
  std::uint32_t patch_count = 0;  // of radiosity; 0: what the scene has
};

// A scene's part in these choices.
struct BakeableScene {
  bool is_model = false;           // it is imported, so its textures could be imported otherwise
  std::uint32_t texture_side = 0;  // the longest, up to the largest --texture-max of the sweep; 0: no textures
  bool is_lit = false;             // it has light of its own and stores no radiosity
};

constexpr const char* kRadiosityEffect = "radiosity";

// Everything that a knob can change.
struct Configuration {
  Settings settings;
  int output = 1;                                        // index into kOutputFormats: the handheld's
  std::uint32_t sphere_columns = kCornellSphereColumns;  // of cornell's sphere
  bool near_lossless = false;                            // rows come from a render server, coded with small errors
  BakeChoices bake;
};

struct Knob {
  const char* name = nullptr;       // "samples"
  const char* what = nullptr;       // "rays through each pixel"
  std::string effect;               // name of the effect that it belongs to
  EffectMask needs = 0;             // effective only if any of these is on; 0: always
  const char* scene = nullptr;      // the only built-in scene with this knob; null: all
  const char* theory = nullptr;     // expected slope of RMSE over time; empty: theory predicts none
  std::vector<double> values;       // least accurate first
  std::vector<const char*> labels;  // one per value; empty: the numbers themselves
  std::function<double(const Configuration& configuration)> get;
  std::function<void(Configuration* configuration, double value)> set;
  double (*price)(double value) = nullptr;  // rough relative frame time; null: the value hardly matters
  bool alone = false;                       // never varied together with others
  bool is_setting = true;                   // can change from frame to frame
  // Tells why `bake` cannot make this choice for the scene, or would make the baseline; empty: it can.
  std::function<std::string(const BakeableScene& scene, double value)> bake_unfit;
};

const std::vector<Knob>& knob_list();

// The choices of `bake`, at the end of the list.
std::vector<Knob> bake_knobs();
// Largest --texture-max of the sweep.
constexpr std::uint32_t kTextureSideSwept = 2048;
inline bool is_bake_choice(const Knob& knob) { return knob.bake_unfit != nullptr; }
// The scene as it was opened, which needs no bake.
inline bool is_as_opened(const BakeChoices& c) {
  const BakeChoices opened;
  return c.texture_side_max == opened.texture_side_max && c.has_mip_maps == opened.has_mip_maps &&
         c.is_compressed == opened.is_compressed && c.patch_count == opened.patch_count;
}

// The judge of its values: see KnobFigures.
Judge judge_of(const Knob& knob);
// "4", or the value's label.
std::string value_label(const Knob& knob, double value);
// The knob's values in order, including the baseline's.
std::vector<double> knob_values(const Knob& knob, const Configuration& baseline);
// True if the knob has an effect in the scene with that name and plan; otherwise *why receives the reason.
bool knob_applies(const Knob& knob, const std::string& scene, const EffectPlan& plan, std::string* why);
// Rough frame time with `value`, relative to the baseline, used to skip values that would take too long.
double relative_price(const Knob& knob, const Configuration& baseline, double value);

}  // namespace pocketray
