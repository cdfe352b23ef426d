// From what was measured of the points of a sweep's plan to its figures.
#pragma once
#include "accuracy/sweep_plan.h"

namespace pocketray {

// The figures of a point so far.
struct PointFigures {
  bool has_errors = false;
  double flip = 0, flip_before = 0, flip_other = kNotMeasured;
  PictureErrors errors;
  double instructions_per_pixel = kNotMeasured, bytes_per_frame = kNotMeasured;
  std::vector<double> ns_per_pixel;  // one per round
};

// From the figures, one per point of the plan, derives sweep->measured with intervals and the front, and sweep->knobs
// with slopes and prices. Takes the size of the picture and the reference's errors from *sweep.
void sum_up(const SweepPlan& plan, const std::vector<PointFigures>& figures, Sweep* sweep);

// The same figures as seen from the other kind of reference, without slopes, prices and strips: ꟻLIP alone is known
// against it.
Sweep against_other(const Sweep& sweep);

}  // namespace pocketray
