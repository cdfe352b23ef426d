// The pictures that a sweep compares with: two of independent seeds, by the path tracer in double precision.
#pragma once
#include "reference/reference.h"
#include "sweep/sweep.h"

namespace pocketray {

// Samples of a pixel, both seeds together. All transport takes an order of magnitude longer for the same error, and
// where it only has to say what the model leaves out, the error of few will do.
std::uint32_t reference_samples(const AccuracyOptions& options, Transport transport);

struct ReferencePictures {
  std::vector<double> one, other, mean;  // exposed light as a display shows it, [0, 1]
  std::vector<float> encoded;            // of the mean
  Levels levels;                         // of the mean, 8 bits a channel
  double rmse = 0, flip = 0;             // what the mean itself may err by
};

// Renders both seeds with all threads, or takes from the folder what is there. After an interrupt *whole is false and
// the rows that are finished are kept; the next call goes on with the others.
Status render_reference(const AccuracyOptions& options, Transport transport, Rig* rig, AccuracyState* state,
                        ReferencePictures* pictures, bool* whole);

}  // namespace pocketray
