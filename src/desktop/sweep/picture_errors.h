// Errors of the picture in a rig's renderer, as a screen shows it.
#pragma once
#include "desktop/sweep/reference_run.h"

namespace pocketray {

// The references that pictures are compared with.
struct Judges {
  ReferencePictures truth, model;
};

// Returns the picture in the rig's renderer as the screen shows it. *bytes_per_frame, unless null, receives the bytes
// of its rows, in a build that can send them. After an interrupt *levels is meaningless.
Status find_levels(const AccuracyOptions& options, Rig* rig, const Configuration& configuration, Levels* levels,
                   double* bytes_per_frame);

// Returns ꟻLIP to a reference. *noise receives what the reference's noise adds to the mean ꟻLIP.
Distance distance_of(const ReferencePictures& reference, const std::vector<float>& shown, std::uint32_t width,
                     std::uint32_t height, double ppd, double* noise);

// Finds the errors of a configuration's picture and, if asked for, the bytes of its rows. After an interrupt there are
// none.
Status find_errors(const AccuracyOptions& options, const Judges& judges, bool counts_bytes,
                   const Configuration& configuration, Rig* rig, PointFigures* f);

}  // namespace pocketray
