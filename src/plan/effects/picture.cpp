#include "base/check.h"
#include "plan/effects/rule.h"

namespace pocketray {
namespace {

EffectDecision decide_supersampling(const EffectCall& c) {
  const std::uint32_t samples = c.settings.samples_per_pixel;
  return decided(samples > 1, "%u sample%s per pixel", samples, samples == 1 ? "" : "s");
}

EffectDecision decide_selective(const EffectCall& c) {
  const float contrast = c.settings.selective_contrast;
  if (contrast == 0) return decided(false, "every pixel traced");
  return decided(true, "contrasts below %.3g interpolated", static_cast<double>(contrast));
}

EffectDecision decide_undersampling(const EffectCall& c) {
  switch (c.settings.resolution) {
    case Resolution::full:
      return decided(false, "all of the pixels traced");
    case Resolution::checkerboard:
      return decided(true, "half of the pixels traced");
    case Resolution::half:
      break;
  }
  return decided(true, "a quarter of the pixels traced");
}

EffectDecision decide_edge_sampling(const EffectCall& c) {
  const std::uint32_t samples = c.settings.edge_samples;
  return decided(samples > 0, "%u sample%s added at edges", samples, samples == 1 ? "" : "s");
}

EffectDecision decide_animation(const EffectCall& c) {
  const std::uint32_t still = c.census.invisible[static_cast<int>(Invisible::still_animation)];
  if (!c.census.is_animated && still > 0)
    return decided(false, "nothing moves (%u animation%s still)", still, still == 1 ? " holds" : "s hold");
  if (!c.census.is_animated) return decided(false, "nothing moves");
  const std::uint32_t count = c.scene.animations.count;
  return decided(true, "%u animation%s", count, count == 1 ? "" : "s");
}

constexpr EffectRule kRules[] = {
    {Effect::supersampling, decide_supersampling},
    {Effect::selective, decide_selective},
    {Effect::undersampling, decide_undersampling},
    {Effect::animation, decide_animation},
    {Effect::edge_sampling, decide_edge_sampling, [](const EffectCall&) { return false; }},
};

}  // namespace

Array<const EffectRule> picture_rules() { return {kRules, sizeof kRules / sizeof kRules[0]}; }

}  // namespace pocketray
