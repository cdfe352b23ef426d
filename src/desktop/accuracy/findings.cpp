#include "desktop/accuracy/findings.h"

#include <algorithm>
#include <cmath>

#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/text.h"

namespace pocketray {

double ms_of(const Sweep& sweep, double ns_per_pixel) { return ns_per_pixel * sweep.width * sweep.height * 1e-6; }

bool is_judged(const Measured& m, Judge judge) {
  return m.missing.empty() && std::isfinite(distance_to(m, judge).flip) && std::isfinite(m.ns_per_pixel.value);
}
bool has_figures(const Measured& m) { return is_judged(m, Judge::model); }

std::vector<const Measured*> values_of(const Sweep& sweep, const std::string& knob) {
  std::vector<const Measured*> result;
  for (const Measured& m : sweep.measured)
    if (m.knob == knob) result.push_back(&m);
  return result;
}

namespace {

bool shows_same(const Measured& a, const Measured& b, Judge judge) {
  const Distance &one = distance_to(a, judge), &other = distance_to(b, judge);
  return one.flip == other.flip && one.one == other.one && one.other == other.other;
}

// Drops configurations that show what one before them shows and are hardly faster: settings that the scene ignores, by
// the noise of their times.
std::vector<const Measured*> without_twins(const std::vector<const Measured*>& all, Judge judge) {
  constexpr double kHardlyFaster = 0.9;
  std::vector<const Measured*> kept;
  for (const Measured* m : all) {
    const bool is_twin = std::any_of(kept.begin(), kept.end(), [&](const Measured* before) {
      return m->ns_per_pixel.value >= kHardlyFaster * before->ns_per_pixel.value && shows_same(*m, *before, judge);
    });
    if (!is_twin) kept.push_back(m);
  }
  return kept;
}

// Returns the front of some configurations, fastest first.
std::vector<const Measured*> front_among(const std::vector<const Measured*>& every, Judge judge) {
  const std::vector<const Measured*> all = without_twins(every, judge);
  std::vector<const Measured*> front;
  std::vector<double> cost;
  std::vector<const Distance*> distance;
  for (const Measured* m : all) cost.push_back(m->ns_per_pixel.value), distance.push_back(&distance_to(*m, judge));
  const std::vector<bool> is_on_front = claimed_front(cost, distance);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (is_on_front[i]) front.push_back(all[i]);
  std::stable_sort(front.begin(), front.end(),
                   [](const Measured* a, const Measured* b) { return a->ns_per_pixel.value < b->ns_per_pixel.value; });
  return front;
}

bool compares_methods(const Measured& m) { return is_judged(m, Judge::truth) && m.is_choice && !m.indirect.empty(); }

}  // namespace

std::vector<const Measured*> front_of(const Sweep& sweep, Judge judge) {
  std::vector<const Measured*> choices;
  for (const Measured& m : sweep.measured)
    if (is_judged(m, judge) && m.is_choice && (!m.is_default || m.knob == "baseline")) choices.push_back(&m);
  return front_among(choices, judge);
}

bool has_judged(const Sweep& sweep, Judge judge) {
  return std::any_of(sweep.measured.begin(), sweep.measured.end(),
                     [&](const Measured& m) { return is_judged(m, judge); });
}

std::vector<std::string> methods_of(const Sweep& sweep) {
  std::vector<std::string> methods;
  for (const Measured& m : sweep.measured)
    if (compares_methods(m) && std::find(methods.begin(), methods.end(), m.indirect) == methods.end())
      methods.push_back(m.indirect);
  return methods;
}

std::vector<const Measured*> method_front(const Sweep& sweep, const std::string& method) {
  std::vector<const Measured*> all;
  for (const Measured& m : sweep.measured)
    if (compares_methods(m) && m.indirect == method) all.push_back(&m);
  return front_among(all, Judge::truth);
}

std::string own_settings(const Measured& m) {
  if (m.knob == "baseline" || m.knob == "indirect") return "";
  if (m.knob != "several") return m.knob + " " + m.value;
  std::string own;
  for (std::size_t begin = 0; begin < m.value.size();) {
    const std::size_t end = std::min(m.value.find(", ", begin), m.value.size());
    const std::string setting = m.value.substr(begin, end - begin);
    if (setting.rfind("indirect ", 0) != 0) own += (own.empty() ? "" : ", ") + setting;
    begin = end + 2;
  }
  return own;
}

KnobEnds ends_of(const Sweep& sweep, const std::string& knob) {
  KnobEnds ends;
  for (const Measured* m : values_of(sweep, knob)) {
    if (!has_figures(*m)) continue;
    if (!ends.worst) ends.worst = m;
    ends.best = m;
    if (m->is_default) ends.standard = m;
  }
  return ends;
}

double flip_by(const KnobFigures& knob, const Measured& m) { return distance_to(m, knob.judge).flip; }

double gain_of(const KnobFigures& knob, const KnobEnds& ends) {
  return ends.worst ? flip_by(knob, *ends.worst) - flip_by(knob, *ends.best) : kNotMeasured;
}

bool gain_claimed(const KnobFigures& knob, const KnobEnds& ends) {
  return ends.worst && is_nearer(distance_to(*ends.worst, knob.judge), distance_to(*ends.best, knob.judge));
}

bool is_paid_in_bytes(const KnobEnds& ends) {
  return ends.worst && std::isfinite(ends.worst->bytes_per_frame) && std::isfinite(ends.best->bytes_per_frame) &&
         ends.worst->bytes_per_frame != ends.best->bytes_per_frame;
}

std::string slope_text(const KnobFigures& knob) {
  if (!knob.has_slope) return knob.theory.empty() ? "" : "theory: " + knob.theory;
  auto hundredths = [](double v) { return (v <= -0.005 ? "−" : "") + format("%.2f", std::fabs(v)); };
  std::string text = "slope of its own RMSE over time " + hundredths(knob.slope.value);
  if (std::isfinite(knob.slope.low) && std::isfinite(knob.slope.high))
    text += " [" + hundredths(knob.slope.low) + ", " + hundredths(knob.slope.high) + "]";
  text += "; RMSE is off that law by " + format("%.1f %%", 100 * knob.slope_misfit);
  return text + (knob.theory.empty() ? "" : "; theory: " + knob.theory);
}

std::string radiosity_text(const Sweep& sweep) {
  const RadiosityPrediction& p = sweep.radiosity;
  if (!p.why_not.empty()) return "bake --radiosity is not predicted: " + p.why_not;
  if (!std::isfinite(p.flip)) return "bake --radiosity is not predicted";
  const std::string frame = figure(ms_of(sweep, p.ns_per_pixel)) + " ms";
  return "bake --radiosity would take " + figure(p.seconds, 2) + " s here, store " +
         format("%.2f MiB", p.bytes / (1 << 20)) + " and give ꟻLIP " + figure(p.flip, 2) + " in " + frame +
         " a frame, where the baseline has " + figure(p.flip_without, 2) + " in " +
         figure(ms_of(sweep, sweep.measured.front().ns_per_pixel.value)) + " ms (predicted)";
}

std::vector<const KnobFigures*> knobs_by_price(const Sweep& sweep) {
  std::vector<const KnobFigures*> knobs;
  for (const KnobFigures& knob : sweep.knobs) knobs.push_back(&knob);
  auto rank = [&](const KnobFigures* knob) {
    if (!std::isfinite(knob->ms_per_flip)) return 2;
    return gain_claimed(*knob, ends_of(sweep, knob->name)) ? 0 : 1;
  };
  std::stable_sort(knobs.begin(), knobs.end(), [&](const KnobFigures* a, const KnobFigures* b) {
    int rank_a = rank(a), rank_b = rank(b);
    return rank_a != rank_b ? rank_a < rank_b : rank_a < 2 && a->ms_per_flip < b->ms_per_flip;
  });
  return knobs;
}

}  // namespace pocketray
