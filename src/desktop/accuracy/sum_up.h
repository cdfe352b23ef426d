// Derives a sweep's figures from the measurements of its plan's points.
#pragma once
#include "desktop/accuracy/sweep_plan.h"

namespace pocketray {

// Measurements of a point so far.
struct PointFigures {
  bool has_errors = false;
  double flip = 0, flip_before = 0, flip_other = kNotMeasured;
  PictureErrors errors;
  double instructions_per_pixel = kNotMeasured, bytes_per_frame = kNotMeasured;
  std::vector<double> ns_per_pixel;  // one per round
};

// Derives sweep->measured, with intervals and the front, and sweep->knobs, with slopes and prices, from the
// measurements, one per point of the plan. Takes the picture's size and the reference's errors from *sweep.
void sum_up(const SweepPlan& plan, const std::vector<PointFigures>& figures, Sweep* sweep);

// Returns the sweep against the other kind of reference, without slopes, prices and strips: only ꟻLIP is known against
// it.
Sweep against_other(const Sweep& sweep);

}  // namespace pocketray
