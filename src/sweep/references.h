// Reference pictures of a sweep: two with independent seeds, by the path tracer in double precision.
#pragma once
#include "reference/reference.h"
#include "sweep/sweep.h"

namespace pocketray {

// Samples per pixel, both seeds together. Full transport takes an order of magnitude longer for the same error; where
// it only measures what the model omits, few samples suffice.
std::uint32_t reference_samples(const AccuracyOptions& options, Transport transport);

struct ReferencePictures {
  std::vector<double> one, other, mean;  // exposed light, clamped to the display range [0, 1]
  std::vector<float> encoded;            // of the mean
  Levels levels;                         // of the mean, 8 bits per channel
  double rmse = 0, flip = 0;             // the mean's own error
};

// Renders both seeds with all threads, reusing rows in the folder. After an interrupt *whole is false and finished rows
// are kept; the next call continues.
Status render_reference(const AccuracyOptions& options, Transport transport, Rig* rig, AccuracyState* state,
                        ReferencePictures* pictures, bool* whole);

}  // namespace pocketray
