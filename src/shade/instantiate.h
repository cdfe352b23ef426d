// Instantiates a part of the kernel once for each combination of effects that its rules tell apart; the plan's is
// selected once per frame.
#pragma once
#include <cstddef>
#include <utility>

#include "base/check.h"
#include "effect/effect.h"

namespace pocketray {

// Each instance that meets the condition also holds the code of some effects, which asks the plan at run time, and
// lacks that of others. Rules apply in order. Fewer instances compile faster and take less memory.
struct InstanceRule {
  enum class Condition { any, none, not_all } condition;
  EffectMask of;
  EffectMask holds, lacks;
};

constexpr InstanceRule with(EffectMask any_of, EffectMask holds, EffectMask lacks = 0) {
  return {InstanceRule::Condition::any, any_of, holds, lacks};
}
constexpr InstanceRule without_any(EffectMask of, EffectMask lacks) {
  return {InstanceRule::Condition::none, of, 0, lacks};
}
constexpr InstanceRule without_all(EffectMask of, EffectMask lacks) {
  return {InstanceRule::Condition::not_all, of, 0, lacks};
}

constexpr bool is_met(const InstanceRule& rule, EffectMask mask) {
  switch (rule.condition) {
    case InstanceRule::Condition::any:
      return (mask & rule.of) != 0;
    case InstanceRule::Condition::none:
      return (mask & rule.of) == 0;
    case InstanceRule::Condition::not_all:
      return (mask & rule.of) != rule.of;
  }
  return false;
}

// How a part of the kernel depends on effects.
template <std::size_t rule_count>
struct InstanceTable {
  EffectMask effects;  // the others have no code in the part
  InstanceRule rules[rule_count];

  // Effects of the instance for a plan.
  constexpr EffectMask instance_of(EffectMask plan) const {
    EffectMask mask = plan & effects & kEffectsBuilt;
    for (const InstanceRule& rule : rules)
      if (is_met(rule, mask)) mask = (mask | (rule.holds & kEffectsBuilt)) & ~rule.lacks;
    return mask;
  }
};

// Part has Function, kTable (an InstanceTable) and instance<mask>(), the function with the code of those effects.
template <class Part>
class Instantiations {
 public:
  using Function = typename Part::Function;

  static Function find(EffectMask plan) {
    return pick(Part::kTable.instance_of(plan), std::make_index_sequence<count()>());
  }

 private:
  static constexpr EffectMask kVaries = Part::kTable.effects & kEffectsBuilt;

  static constexpr EffectMask next_subset(EffectMask mask) { return (mask - kVaries) & kVaries; }

  static constexpr std::size_t count() {
    std::size_t n = 0;
    EffectMask mask = 0;
    do {
      const EffectMask instance = Part::kTable.instance_of(mask);
      if (instance == mask) ++n;
      if (Part::kTable.instance_of(instance) != instance) return 0;
      mask = next_subset(mask);
    } while (mask);
    return n;
  }
  static_assert(count() > 0, "rules that change their own result");

  struct Masks {
    EffectMask mask[count()] = {};
    constexpr Masks() {
      std::size_t n = 0;
      EffectMask next = 0;
      do {
        if (Part::kTable.instance_of(next) == next) mask[n++] = next;
        next = next_subset(next);
      } while (next);
    }
  };
  static constexpr Masks kMasks = {};

  template <std::size_t... index>
  static Function pick(EffectMask wanted, std::index_sequence<index...>) {
    static constexpr Function table[] = {Part::template instance<kMasks.mask[index]>()...};
    std::size_t begin = 0, end = sizeof...(index);  // masks rise
    while (end - begin > 1) {
      const std::size_t middle = begin + (end - begin) / 2;
      (kMasks.mask[middle] <= wanted ? begin : end) = middle;
    }
    CHECK(kMasks.mask[begin] == wanted);
    return table[begin];
  }
};

}  // namespace pocketray
