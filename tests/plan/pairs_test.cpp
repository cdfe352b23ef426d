// What each pair of effects, settings and uses does to each other, as the declarations have it.
#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "effect/effect_list.h"
#include "effect/setting_list.h"
#include "plan/resolve.h"

using namespace pocketray;

namespace {

constexpr char kFile[] = POCKETRAY_SOURCE "/tests/plan/pairs.txt";

struct Table {
  std::string text;
  int line_count = 0;
  void add(const std::string& a, const std::string& b, const std::string& what) {
    text += a + ", " + b + ": " + what + "\n";
    ++line_count;
  }
};

std::string option(const SettingRow& row) { return std::string("--") + row.name; }

template <class Visit>
void each_effect(EffectMask mask, Visit visit) {
  for (const EffectRow& row : kEffectList)
    if (mask & bit(row.effect)) visit(row);
}

void add_effect_pairs(Table* table) {
  table->text += "\n# effects\n";
  for (const EffectRow& row : kEffectList)
    each_effect(row.yields_to, [&](const EffectRow& other) {
      table->add(row.name, other.name, std::string(row.name) + " is off: " + other.because);
    });
  for (const EffectRow& row : kEffectList) {
    const EffectMask mask = bit(row.effect);
    if (const char* because = unfollowed_because(mask)) table->add(row.name, "coherence", because);
    if (const char* because = unfollowed_because(mask, true)) table->add(row.name, "the paper's tables", because);
    if (row.followed == Followed::as_lights_stand) table->add(row.name, "coherence", "until a light changes");
    if (const char* because = unshared_because(mask)) table->add(row.name, "light maps", because);
  }
}

// A setting acts on another by the effects that it turns on.
void add_setting_pairs(Table* table) {
  table->text += "\n# settings\n";
  for (const SettingRow& row : kSettingList) {
    each_effect(row.effects, [&](const EffectRow& effect) { table->add(option(row), effect.name, "controls it"); });
    if (row.seen_with != kAlways)
      each_effect(row.seen_with & ~row.effects,
                  [&](const EffectRow& effect) { table->add(option(row), effect.name, "is read by it"); });
    if (!(row.effects & kFirstHitEffects)) table->add(option(row), "--aov", "no effect");
    table->add(option(row), "--budget-ms", "refused: chosen by it");
  }
  for (const SettingRow& row : kSettingList)
    for (const SettingRow& other : kSettingList)
      each_effect(row.effects, [&](const EffectRow& first) {
        each_effect(other.effects, [&](const EffectRow& second) {
          if (second.yields_to & bit(first.effect))
            table->add(option(row), option(other), std::string(second.name) + " may be off: " + first.because);
        });
      });
}

void add_use_pairs(Table* table) {
  table->text += "\n# uses of frames\n";
  for (const UseRule& rule : kUseRules)
    table->add(kUseList[static_cast<int>(rule.use)].name, kUseList[static_cast<int>(rule.other)].name,
               std::string(rule.needs ? "needed: " : "refused: ") + rule.because);
}

std::string all_pairs() {
  Table table;
  table.text =
      "# Pairs that do something to each other; all others are independent. Written from the declarations by\n"
      "# POCKETRAY_WRITE=1 test_plan --test-case='pairs_*'\n";
  add_effect_pairs(&table);
  add_setting_pairs(&table);
  add_use_pairs(&table);
  const int names = kEffectCount + kSettingCount + kUseCount + 2;  // and the paper's tables, and light maps
  table.text += "\n" + std::to_string(table.line_count) + " of " + std::to_string(names * (names - 1) / 2) + " pairs\n";
  return table.text;
}

}  // namespace

// Goal: a changed declaration shows what it changes for every other feature. Method: the table of all pairs, generated,
// against the committed one.
TEST_CASE("pairs_are_those_committed") {
  const std::string pairs = all_pairs();
  if (std::getenv("POCKETRAY_WRITE")) std::ofstream(kFile) << pairs;
  std::ifstream file(kFile);
  const std::string committed((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  CHECK(pairs == committed);
}
