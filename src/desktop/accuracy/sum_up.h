// Derives a sweep's figures from the measurements of its plan's points.
#pragma once
#include "desktop/accuracy/sweep_plan.h"

namespace pocketray {

// Measurements of a point so far.
struct PointFigures {
  bool has_errors = false;
  Distance truth, model;
  double flip_before = 0;
  std::array<double, kOutputFormatCount> flip_as = {kNotMeasured, kNotMeasured, kNotMeasured};
  PictureErrors errors;
  double instructions_per_pixel = kNotMeasured, bytes_per_frame = kNotMeasured;
  double stored_bytes = kNotMeasured, bake_seconds = kNotMeasured;
  std::vector<double> ns_per_pixel;  // one per round
};

// Derives sweep->measured, with intervals and the judge's front, and sweep->knobs, with slopes and prices by the model,
// from the measurements, one per point of the plan. Takes the picture's size, the judge and the references' errors from
// *sweep.
void sum_up(const SweepPlan& plan, const std::vector<PointFigures>& figures, Sweep* sweep);

}  // namespace pocketray
