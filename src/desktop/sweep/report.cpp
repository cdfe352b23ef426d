#include <nlohmann/json.hpp>

#include "desktop/sweep/report.h"

#include "desktop/accuracy/findings.h"

namespace pocketray {
namespace {

Json interval_json(const Interval& i) { return {{"value", i.value}, {"low", i.low}, {"high", i.high}}; }

Json measured_json(const Measured& m) {
  Json json = {{"knob", m.knob}, {"value", m.value}, {"default", m.is_default}};
  if (!m.missing.empty()) {
    json["missing"] = m.missing;
    return json;
  }
  json["ns_per_pixel"] = interval_json(m.ns_per_pixel);
  json["time_ratio"] = interval_json(m.time_ratio);
  json["instructions_per_pixel"] = m.instructions_per_pixel;  // NaN and infinity become null
  json["bytes_per_frame"] = m.bytes_per_frame;
  json["flip"] = m.flip;
  json["flip_before"] = m.flip_before;
  json["flip_other"] = m.flip_other;
  if (!m.indirect.empty()) json["indirect"] = m.indirect;
  json["rmse"] = m.errors.rmse;
  json["rel_mse"] = m.errors.rel_mse;
  json["p99"] = m.errors.p99;
  json["max"] = m.errors.max;
  json["bias"] = m.errors.bias;
  json["psnr"] = m.errors.psnr;
  json["pareto"] = m.pareto;
  if (!m.note.empty()) json["note"] = m.note;
  return json;
}

void print_value(const Sweep& sweep, const Measured& m, bool in_bytes) {
  std::printf("    %-16s %9.2f ms  ×%-7.3g ꟻLIP %.4f  RMSE %.5f", m.value.c_str(), ms_of(sweep, m.ns_per_pixel.value),
              m.time_ratio.value, m.flip, m.errors.rmse);
  if (in_bytes) std::printf("  %.0f bytes per frame", m.bytes_per_frame);
  std::printf("%s%s\n", m.is_default ? "  baseline" : "", m.pareto ? "  *" : "");
}

// Prints the least accurate, the baseline's and the best value.
void print_knob(const Sweep& sweep, const KnobFigures& k) {
  std::printf("  %s: %s\n", k.name.c_str(), k.what.c_str());
  KnobEnds ends = ends_of(sweep, k.name);
  for (const Measured* m : values_of(sweep, k.name))
    if (m == ends.worst || m == ends.standard || m == ends.best) {
      print_value(sweep, *m, is_paid_in_bytes(ends));
      if (!m->note.empty()) std::printf("      (%s)\n", m->note.c_str());
    }
  if (k.ms_per_flip > 0) std::printf("    %.3g ms per .01 ꟻLIP\n", k.ms_per_flip);
  if (k.ms_per_flip <= 0) std::printf("    the best value costs no extra time\n");
  if (k.has_slope)
    std::printf("    its own RMSE scales as time to the power of %.2f (%.2f … %.2f), within %.1f %%%s%s\n",
                k.slope.value, k.slope.low, k.slope.high, 100 * k.slope_misfit,
                k.theory.empty() ? "" : "; theory: ", k.theory.c_str());
}

void print_front(const Sweep& sweep) {
  std::printf("Pareto front: no other configuration is faster at equal or lower ꟻLIP\n");
  for (const Measured* m : front_of(sweep))
    std::printf("  %9.2f ms  ꟻLIP %.4f  %s %s\n", ms_of(sweep, m->ns_per_pixel.value), m->flip, m->knob.c_str(),
                m->value.c_str());
}

}  // namespace

Json sweep_json(const Sweep& sweep) {
  Json measured = Json::array(), knobs = Json::array();
  for (const Measured& m : sweep.measured) measured.push_back(measured_json(m));
  for (const KnobFigures& k : sweep.knobs)
    knobs.push_back({{"name", k.name},
                     {"what", k.what},
                     {"effect", k.effect},
                     {"theory", k.theory},
                     {"slope", k.has_slope ? interval_json(k.slope) : Json()},
                     {"slope_misfit", k.has_slope ? Json(k.slope_misfit) : Json()},
                     {"ms_per_flip", k.ms_per_flip}});
  return {{"scene", sweep.scene},
          {"machine", sweep.machine},
          {"width", sweep.width},
          {"height", sweep.height},
          {"rounds", sweep.rounds},
          {"pixels_per_degree", sweep.pixels_per_degree},
          {"output", sweep.output},
          {"reference", sweep.reference},
          {"reference_samples", sweep.reference_samples},
          {"reference_rmse", sweep.reference_rmse},
          {"reference_flip", sweep.reference_flip},
          {"other_samples", sweep.other_samples},
          {"other_flip", sweep.other_flip},
          {"model_flip", sweep.model_flip},
          {"model_rmse", sweep.model_rmse},
          {"notes", sweep.notes},
          {"knobs", knobs},
          {"measured", measured}};
}

void print_sweep(const Sweep& sweep) {
  std::printf("%s: %u×%u, %s, %u rounds, %s; reference: %s, %u samples per pixel\n", sweep.scene.c_str(), sweep.width,
              sweep.height, sweep.machine.c_str(), sweep.rounds, sweep.output.c_str(), sweep.reference.c_str(),
              sweep.reference_samples);
  std::printf(
      "  the reference's own error is RMSE %.2g and ꟻLIP %.2g: differences below %.2g and %.2g are not claimed\n",
      sweep.reference_rmse, sweep.reference_flip, kClaimFactor * sweep.reference_rmse,
      kClaimFactor * sweep.reference_flip);
  std::printf(
      "  the converged model differs from full light transport by RMSE %.3g, ꟻLIP %.3g%s\n", sweep.model_rmse,
      sweep.model_flip,
      sweep.model_flip < kClaimFactor * sweep.model_flip_error ? " at most: that reference is too noisy to tell" : "");
  for (const KnobFigures& k : sweep.knobs) print_knob(sweep, k);
  print_front(sweep);
  for (const std::string& note : sweep.notes) std::printf("  %s\n", note.c_str());
}

}  // namespace pocketray
