#include "split/effect_choice.h"

#include <algorithm>

namespace pocketray {

void observe_effect_times(EffectModel* m, const EffectTimes& t) {
  smooth(&m->prepare_ns, t.prepare_ns), smooth(&m->device_ns, t.device_ns), smooth(&m->server_ns, t.server_ns);
  smooth(&m->transfer_ns, t.transfer_ns), smooth(&m->add_ns, t.add_ns);
}

double predict_effect_ns(const EffectModel& m) {
  if (!is_known(m.device_ns)) return 0;
  return value_or(m.prepare_ns, 0) +
         std::max(value_or(m.device_ns, 0), value_or(m.server_ns, 0) + value_or(m.transfer_ns, 0)) +
         value_or(m.add_ns, 0);
}

void observe_choice(EffectChoice* c, bool by_effect, double predicted_ns, double ns) {
  ++c->count;
  if (predicted_ns > 0) smooth(by_effect ? &c->effect_error : &c->rows_error, ns / predicted_ns);
}

bool choose_by_effect(EffectChoice* c, double rows_ns, double effect_ns) {
  if (c->count < kTrialFrames) return c->by_effect;
  const bool is_known_both = effect_ns > 0 && rows_ns > 0;
  const bool other_is_better = c->by_effect ? !(effect_ns < rows_ns) : effect_ns < kFasterPart * rows_ns;
  const bool stays = is_known_both && !other_is_better;
  if (c->on_trial) {
    c->on_trial = false;
    c->retry = stays ? kRetryFramesMin : std::min(2 * c->retry, kRetryFrames);
    if (stays) return c->by_effect;
  } else if (is_known_both && other_is_better) {
    c->retry = kRetryFramesMin;
  } else if (c->count >= c->retry) {
    c->on_trial = true;
  } else {
    return c->by_effect;
  }
  c->by_effect = !c->by_effect;
  c->count = 0;
  return c->by_effect;
}

}  // namespace pocketray
