// Predicts time, bytes and error of `bake --radiosity` for a scene that stores none, without baking it.
#pragma once
#include "desktop/sweep/picture_errors.h"
#include "desktop/sweep/rigs.h"

namespace pocketray {

// States what the bakes of a sweep will take, before any.
std::string bake_note(const SweepPlan& plan, const Scene& scene);

// Predicts time and bytes from a sample of the solver's work, and the frame's time and error from a solution of few
// patches. After an interrupt *whole is false.
Status predict_radiosity(const AccuracyOptions& options, const Judges& judges, Rigs* rigs, Sweep* sweep, bool* whole);

}  // namespace pocketray
