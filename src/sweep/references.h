// Reference pictures of a sweep, by the path tracer in double precision.
#pragma once
#include "sweep/reference_run.h"

namespace pocketray {

// Samples per pixel, both halves together. Full transport takes an order of magnitude longer for the same error; where
// it only measures what the model omits, few samples suffice.
std::uint32_t reference_samples(const AccuracyOptions& options, Transport transport);

// If --reference names a file, finds its kind and samples; otherwise checks that it names a kind.
Status name_reference(AccuracyOptions* options);

// Takes the reference's samples with all threads: those in the sweep's folder, else in the file of the options, else in
// the scene's file in the cache and as many more as the options ask for. After an interrupt *whole is false; the next
// call continues.
Status render_reference(const AccuracyOptions& options, Transport transport, Rig* rig, AccuracyState* state,
                        ReferencePictures* pictures, bool* whole);

}  // namespace pocketray
