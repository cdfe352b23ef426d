#include "plan/resolve.h"

#include <cstdarg>
#include <cstdio>

#include "base/check.h"
#include "effect/effect_list.h"
#include "plan/plan_effects.h"

namespace pocketray {
namespace {

const EffectRow& first_row(EffectMask mask) {
  CHECK(mask != 0);
  return kEffectList[__builtin_ctzll(mask)];
}

const char* because_of(EffectMask mask) { return mask ? first_row(mask).because : nullptr; }

struct NoteWriter {
  char* text;
  std::size_t used = 0;

  void add(const char* format, ...) __attribute__((format(printf, 2, 3))) {
    va_list arguments;
    va_start(arguments, format);
    int written = std::vsnprintf(text + used, kNoteBytes - used, format, arguments);
    va_end(arguments);
    CHECK(written >= 0);
    CHECK_LT(used, static_cast<std::size_t>(kNoteBytes));
    used += static_cast<std::size_t>(written);
    if (used >= kNoteBytes) used = kNoteBytes - 1;
  }
  // Adds the effects' names, with the reasons of the plan if there is one.
  void add_effects(EffectMask mask, const EffectPlan* plan) {
    const char* separator = "";
    for (const EffectRow& row : kEffectList) {
      if (!(mask & bit(row.effect))) continue;
      add("%s%s", separator, row.name);
      if (plan) add(" is off (%s)", plan->decisions[static_cast<int>(row.effect)].reason);
      separator = ", ";
    }
  }
};

NoteWriter begin_note(Notes* notes) {
  CHECK(notes != nullptr);
  CHECK_LT(notes->count, kNoteMax);
  return {notes->text[notes->count++]};
}

// Returns the effects that read the setting.
EffectMask readers_of(const SettingRow& row) { return row.seen_with == kAlways ? row.effects : row.seen_with; }

// Returns whether the setting decides which pixels are traced; these turn off effects that need every pixel.
bool interpolates(const SettingRow& row) { return row.seen_with == kAlways; }

void note_unread(const SettingRow& row, const EffectPlan& plan, Notes* notes) {
  CHECK(readers_of(row) != 0);
  NoteWriter note = begin_note(notes);
  note.add("--%s has no effect: ", row.name);
  note.add_effects(readers_of(row), &plan);
  const EffectMask methods = readers_of(row) & kIndirectEffects;
  if (methods && methods == row.effects) note.add("; --indirect %s turns it on", first_row(methods).name);
}

void note_setting(const SettingRow& row, const Scene& scene, const Asked& asked, const EffectPlan& plan, Notes* notes) {
  Settings without = asked.settings;
  row.field.set(&without, row.field.get(Quality()));
  const EffectMask mask_without = plan_effects(scene, without).mask;
  const EffectMask left_out = mask_without & ~plan.mask & ~row.effects;
  if (mask_without == plan.mask && !(readers_of(row) & plan.mask)) {
    note_unread(row, plan, notes);
  } else if (asked.aov && !(row.effects & kFirstHitEffects)) {
    begin_note(notes).add("--%s has no effect on --aov %s, which shows what the pixels' centres hit", row.name,
                          asked.aov);
  } else if (interpolates(row) && left_out) {
    NoteWriter note = begin_note(notes);
    note.add("--%s leaves out: ", row.name);
    note.add_effects(left_out, nullptr);
  }
}

// Notes effects that --effects names in vain; `all` names none.
void note_forced(const Settings& settings, const EffectPlan& plan, Notes* notes) {
  if (settings.forced_on == kAllEffects) return;
  const EffectMask refused = settings.forced_on & ~settings.forced_off & ~plan.mask;
  if (!refused) return;
  NoteWriter note = begin_note(notes);
  note.add("--effects cannot turn on what lacks its cause: ");
  note.add_effects(refused, &plan);
}

const UseRow& row_of(Use use) {
  const UseRow& row = kUseList[static_cast<int>(use)];
  CHECK(row.use == use);  // rows stand in the order of their numbers
  return row;
}
const char* name_of(const Uses& uses, Use use) {
  const char* given = uses.names[static_cast<int>(use)];
  return given ? given : row_of(use).name;
}

Status refusal(const Uses& uses, const UseRule& rule) {
  CHECK(rule.because != nullptr && rule.use != rule.other);
  CHECK(!rule.needs || row_of(rule.other).give != nullptr);
  const char *drop = row_of(rule.use).drop, *drop_other = row_of(rule.other).drop;
  const char *name = name_of(uses, rule.use), *other = name_of(uses, rule.other);
  const char* word = drop ? "" : "drop ";
  if (!drop) drop = name;
  if (rule.needs) return failure("%.200s %s: %s, or %s%.100s", name, rule.because, row_of(rule.other).give, word, drop);
  if (drop_other) return failure("%.200s %s: %s%.100s, or %s", name, rule.because, word, drop, drop_other);
  return failure("%.200s %s: %s%.100s or %s%.100s", name, rule.because, word, drop, *word ? "" : "drop ", other);
}

}  // namespace

void let_effects_yield(EffectMask forced_off, EffectPlan* plan) {
  CHECK(plan != nullptr);
  EffectMask on = 0;
  for (const EffectRow& row : kEffectList) {
    EffectDecision* decision = &plan->decisions[static_cast<int>(row.effect)];
    if (!decision->on || has(forced_off, row.effect)) continue;
    if (const char* because = because_of(row.yields_to & on)) {
      decision->on = false;
      std::snprintf(decision->reason, sizeof decision->reason, "%s", because);
    } else {
      on |= bit(row.effect);
    }
  }
}

const char* unfollowed_because(EffectMask mask, bool by_tables) {
  mask &= kEffectsBuilt;
  if (by_tables && (mask & effects_with(&EffectRow::followed, Followed::by_neighbours)))
    return "the tables do not track which pixels share light";
  return because_of(mask & effects_with(&EffectRow::followed, Followed::never));
}

const char* unshared_because(EffectMask mask) {
  return because_of(mask & kEffectsBuilt & effects_with(&EffectRow::shared, Shared::rows));
}

void trace_all_pixels(Quality* quality) {
  CHECK(quality != nullptr);
  for (const SettingRow& row : kSettingList)
    if (row.effects & kInterpolatingEffects) row.field.set(quality, row.exact);
}

Status check_uses(const Uses& uses) {
  for (const UseRule& rule : kUseRules)
    if ((uses.mask & bit(rule.use)) && ((uses.mask & bit(rule.other)) != 0) != rule.needs) return refusal(uses, rule);
  return success();
}

Notes find_requests_without_effect(const Scene& scene, const Asked& asked) {
  Notes notes;
  const EffectPlan plan = plan_effects(scene, asked.settings);
  for (const SettingRow& row : kSettingList)
    if (row.field.get(asked.settings) != row.field.get(Quality())) note_setting(row, scene, asked, plan, &notes);
  note_forced(asked.settings, plan, &notes);
  if (asked.settings.coherence == CoherenceMode::on && asked.whole_because)
    begin_note(&notes).add("--coherence on has no effect: %s", asked.whole_because);
  return notes;
}

}  // namespace pocketray
