#include <cmath>
#include <nlohmann/json.hpp>

#include "desktop/sweep/report.h"

#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/knob_list.h"

namespace pocketray {
namespace {

Json interval_json(const Interval& i) { return {{"value", i.value}, {"low", i.low}, {"high", i.high}}; }

Json reference_json(const ReferenceFigures& reference) {
  return {{"samples", reference.samples}, {"flip", reference.flip}, {"rmse", reference.rmse}};
}

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
  json["stored_bytes"] = m.stored_bytes;
  json["bake_seconds"] = m.bake_seconds;
  json["flip_truth"] = m.truth.flip;
  json["flip_model"] = m.model.flip;
  json["flip_before"] = m.flip_before;
  for (int i = 0; i < kOutputFormatCount; ++i)
    json["flip_as"][kOutputFormats[i].name] = m.flip_as[static_cast<std::size_t>(i)];
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

Json prediction_json(const RadiosityPrediction& p) {
  if (!p.why_not.empty()) return {{"why_not", p.why_not}};
  return {{"bake_seconds", p.seconds},
          {"stored_bytes", p.bytes},
          {"ns_per_pixel", p.ns_per_pixel},
          {"flip_truth", p.flip},
          {"flip_truth_without", p.flip_without}};
}

void print_value(const Sweep& sweep, const KnobFigures& k, const Measured& m, bool in_bytes) {
  std::printf("    %-16s %9.2f ms  ×%-7.3g ꟻLIP %.4f", m.value.c_str(), ms_of(sweep, m.ns_per_pixel.value),
              m.time_ratio.value, flip_by(k, m));
  if (k.judge == Judge::model) std::printf("  RMSE %.5f", m.errors.rmse);
  if (in_bytes) std::printf("  %.0f bytes per frame", m.bytes_per_frame);
  if (k.is_baked) std::printf("  %.2f MiB stored", m.stored_bytes / (1 << 20));
  if (std::isfinite(m.bake_seconds)) std::printf(", baked in %.2g s", m.bake_seconds);
  std::printf("%s%s\n", m.is_default ? "  baseline" : "", m.pareto ? "  *" : "");
}

// Prints the least accurate, the baseline's and the best value.
void print_knob(const Sweep& sweep, const KnobFigures& k) {
  std::printf("  %s: %s; error against %s\n", k.name.c_str(), k.what.c_str(), text_of(k.judge));
  KnobEnds ends = ends_of(sweep, k.name);
  for (const Measured* m : values_of(sweep, k.name))
    if (m == ends.worst || m == ends.standard || m == ends.best || (k.is_baked && m->missing.empty())) {
      print_value(sweep, k, *m, is_paid_in_bytes(ends));
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
  std::printf("the front: no other setting is as fast and nearer to %s, by ꟻLIP (0: equal; .05: seen at once)\n",
              text_of(sweep.judge));
  for (const Measured* m : front_of(sweep, sweep.judge))
    std::printf("  %9.2f ms  ꟻLIP %.4f  %s %s\n", ms_of(sweep, m->ns_per_pixel.value),
                distance_to(*m, sweep.judge).flip, m->knob.c_str(), m->value.c_str());
}

}  // namespace

Json sweep_json(const Sweep& sweep) {
  Json measured = Json::array(), knobs = Json::array(), quality = Json::array();
  for (const LevelPicture& c : sweep.quality)
    quality.push_back({{"level", c.level}, {"settings", c.settings}, {"ms", c.ms}, {"flip", c.flip}});
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
          {"judge", name_of(sweep.judge)},
          {"truth", reference_json(sweep.truth)},
          {"model", reference_json(sweep.model)},
          {"model_distance", {{"flip", sweep.model_distance}, {"rmse", sweep.model_rmse}}},
          {"quality", quality},
          {"radiosity_prediction", prediction_json(sweep.radiosity)},
          {"notes", sweep.notes},
          {"knobs", knobs},
          {"measured", measured}};
}

void print_sweep(const Sweep& sweep) {
  std::printf("%s: %u×%u, %s, %u rounds, %s\n", sweep.scene.c_str(), sweep.width, sweep.height, sweep.machine.c_str(),
              sweep.rounds, sweep.output.c_str());
  for (Judge judge : {Judge::truth, Judge::model})
    std::printf("  reference: %s, %u samples per pixel, its own error ꟻLIP %.2g, RMSE %.2g\n", text_of(judge),
                figures_of(sweep, judge).samples, figures_of(sweep, judge).flip, figures_of(sweep, judge).rmse);
  std::printf("  the converged model differs from full light transport by ꟻLIP %.3g, RMSE %.3g\n", sweep.model_distance,
              sweep.model_rmse);
  for (const LevelPicture& c : sweep.quality)
    std::printf("  --quality %-7s %9.2f ms  ꟻLIP %.4f  %s\n", c.level.c_str(), c.ms, c.flip, c.settings.c_str());
  for (const KnobFigures& k : sweep.knobs) print_knob(sweep, k);
  print_front(sweep);
  std::printf("  %s\n", radiosity_text(sweep).c_str());
  for (const std::string& note : sweep.notes) std::printf("  %s\n", note.c_str());
}

}  // namespace pocketray
