// EffectPlan: the decision for a scene and its settings, with reasons.
#pragma once
#include "effect/effect.h"

namespace pocketray {

struct EffectDecision {
  bool on = false;
  char reason[96] = {0};  // "2 of 7 materials reflect", "no material transmits"
};

struct EffectPlan {
  EffectMask mask = 0;
  EffectDecision decisions[kEffectCount];
};

}  // namespace pocketray
