#include "plan/effects/rule.h"

#include <cstdarg>
#include <cstdio>

#include "base/check.h"
#include "base/limits.h"
#include "indirect/environment.h"

namespace pocketray {

EffectDecision decided(bool on, const char* format, ...) {
  CHECK(format != nullptr);
  EffectDecision decision;
  decision.on = on;
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(decision.reason, sizeof decision.reason, format, arguments);
  va_end(arguments);
  return decision;
}

EffectDecision by_materials(const EffectCall& call, std::uint32_t count, const char* verb) {
  const std::uint32_t all = call.census.materials;
  CHECK_LE(count, all);
  return count ? decided(true, "%u of %u materials %s", count, all, verb)
               : decided(false, "none of %u materials %s", all, verb);
}

EffectDecision by_materials(const EffectCall& call, std::uint32_t count, const char* verb, Invisible invisible) {
  return with_invisible(call, by_materials(call, count, verb), invisible);
}

EffectDecision with_invisible(const EffectCall& call, EffectDecision decision, Invisible invisible) {
  static constexpr const char* kTexts[] = {"with a black texture",
                                           "with alpha 1",
                                           "with alpha above its cut-off",
                                           "with a flat one",
                                           "with a white one",
                                           "with a uniform one",
                                           "with a uniform one",
                                           "with that of its face",
                                           "still",
                                           "with intensity 0",
                                           "with intensity 0",
                                           "with intensity 0",
                                           "out of range",
                                           "out of range",
                                           "with index 1 and no tint",
                                           "white",
                                           "with a black texture",
                                           "with a black texture",
                                           "with a black texture",
                                           "with a black texture",
                                           "with a texture of alpha 0"};
  static_assert(sizeof kTexts / sizeof kTexts[0] == kInvisibleCount, "one for each");
  const int what = static_cast<int>(invisible);
  CHECK(what < kInvisibleCount && decision.reason[0] != 0);
  const std::uint32_t count = call.census.invisible[what];
  if (decision.on || count == 0) return decision;
  return decided(false, "%s (%u %s)", EffectDecision(decision).reason, count, kTexts[what]);
}

EffectDecision by_count(std::uint32_t count, const char* what) {
  CHECK(what != nullptr);
  return count ? decided(true, "%u %s%s", count, what, count == 1 ? "" : "s") : decided(false, "no %s", what);
}

bool selects_lights(const EffectCall& call) {
  return call.settings.light_tolerance > 0 && call.census.emissive + call.census.light_count >= kSelectedLightsMin;
}

bool shows_environment(const EffectCall& call) {
  return environment_of(call.scene) && !has(call.settings.forced_off, Effect::environment);
}

}  // namespace pocketray
