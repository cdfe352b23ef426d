#include "plan/unused_settings.h"

#include <cstdarg>
#include <cstdio>

#include "base/check.h"
#include "effect/effect_list.h"
#include "plan/plan_effects.h"

namespace pocketray {
namespace {

struct NoteWriter {
  char* text;
  std::size_t used = 0;

  void add(const char* format, ...) __attribute__((format(printf, 2, 3))) {
    va_list arguments;
    va_start(arguments, format);
    int written = std::vsnprintf(text + used, kUnusedNoteBytes - used, format, arguments);
    va_end(arguments);
    CHECK(written >= 0);
    CHECK_LT(used, static_cast<std::size_t>(kUnusedNoteBytes));
    used += static_cast<std::size_t>(written);
    if (used >= kUnusedNoteBytes) used = kUnusedNoteBytes - 1;
  }
};

// Returns the effects that read the setting.
EffectMask readers_of(const SettingRow& row) { return row.seen_with == kAlways ? row.effects : row.seen_with; }

// Returns whether the setting decides which pixels are traced; these turn off effects that need every pixel.
bool interpolates(const SettingRow& row) { return row.seen_with == kAlways; }

void add_unused(const SettingRow& row, const EffectPlan& plan, NoteWriter note) {
  CHECK(readers_of(row) != 0);
  note.add("--%s has no effect: ", row.name);
  const char* separator = "";
  for (const EffectRow& effect : kEffectList) {
    if (!(readers_of(row) & bit(effect.effect))) continue;
    const char* reason = plan.decisions[static_cast<int>(effect.effect)].reason;
    note.add("%s%s is off (%s)", separator, effect.name, reason);
    separator = ", ";
  }
  const EffectMask methods = readers_of(row) & kIndirectEffects;
  if (methods && methods == row.effects)
    note.add("; --indirect %s turns it on", kEffectList[__builtin_ctzll(methods)].name);
}

void add_left_out(const SettingRow& row, EffectMask left_out, NoteWriter note) {
  CHECK(left_out != 0);
  note.add("--%s leaves out: ", row.name);
  const char* separator = "";
  for (const EffectRow& effect : kEffectList) {
    if (!(left_out & bit(effect.effect))) continue;
    note.add("%s%s", separator, effect.name);
    separator = ", ";
  }
}

}  // namespace

UnusedSettings find_unused_settings(const Scene& scene, const Settings& asked) {
  UnusedSettings unused;
  const EffectPlan plan = plan_effects(scene, asked);
  for (const SettingRow& row : kSettingList) {
    const double standard = row.field.get(Quality());
    if (row.field.get(asked) == standard) continue;
    Settings without = asked;
    row.field.set(&without, standard);
    const EffectMask mask_without = plan_effects(scene, without).mask;
    const EffectMask left_out = mask_without & ~plan.mask & ~row.effects;
    CHECK_LT(unused.count, kSettingCount);
    NoteWriter note = {unused.notes[unused.count]};
    if (mask_without == plan.mask && !(readers_of(row) & plan.mask)) {
      add_unused(row, plan, note);
      ++unused.count;
    } else if (interpolates(row) && left_out) {
      add_left_out(row, left_out, note);
      ++unused.count;
    }
  }
  return unused;
}

}  // namespace pocketray
