#include "split/effect_choice.h"

#include <algorithm>

namespace pocketray {

double predict_effect_ns(const EffectChoice& c) {
  if (!is_known(c.device_ns)) return 0;
  auto value = [](const Smoothed& s) { return static_cast<double>(s.value); };
  return value(c.prepare_ns) + std::max(value(c.device_ns), value(c.server_ns) + value(c.transfer_ns)) +
         value(c.add_ns);
}

void observe_rows_frame(EffectChoice* c, double ns) {
  smooth(&c->rows_ns, ns);
  ++c->rows_count;
}

void observe_effect_frame(EffectChoice* c, const EffectTimes& t) {
  smooth(&c->prepare_ns, t.prepare_ns), smooth(&c->device_ns, t.device_ns), smooth(&c->server_ns, t.server_ns);
  smooth(&c->transfer_ns, t.transfer_ns), smooth(&c->add_ns, t.add_ns);
  ++c->effect_count;
}

bool choose_by_effect(EffectChoice* c) {
  const std::uint32_t tried = c->by_effect ? c->effect_count : c->rows_count;
  if (tried < kTrialFrames) return c->by_effect;
  const double effect_ns = predict_effect_ns(*c), rows_ns = static_cast<double>(c->rows_ns.value);
  const bool is_known_both = effect_ns > 0 && rows_ns > 0;
  const double own = c->by_effect ? effect_ns : rows_ns, other = c->by_effect ? rows_ns : effect_ns;
  if (!is_known_both || tried >= kRetryFrames || other < kFasterPart * own) {
    c->by_effect = !c->by_effect;
    c->rows_count = c->effect_count = 0;
  }
  return c->by_effect;
}

}  // namespace pocketray
