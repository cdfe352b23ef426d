// Reference pictures of a sweep, by the path tracer in double precision.
#pragma once
#include "desktop/sweep/reference_run.h"

namespace pocketray {

// Samples per pixel, both halves together. Full transport takes an order of magnitude longer for equal error; where it
// only measures what the model omits, few samples suffice.
std::uint32_t reference_samples(const AccuracyOptions& options, Transport transport);

// If --reference names a file, finds its kind and samples; otherwise checks that it names a kind.
Status name_reference(AccuracyOptions* options);

// Takes the reference's samples with all threads: those in the sweep's folder, otherwise those in the options' file,
// otherwise those in the scene's cached file plus as many more as the options request. After an interrupt *whole is
// false; the next call continues. `later`: told with the progress.
Status render_reference(const AccuracyOptions& options, Transport transport, const LaterWork& later, Rig* rig,
                        AccuracyState* state, ReferencePictures* pictures, bool* whole);

}  // namespace pocketray
