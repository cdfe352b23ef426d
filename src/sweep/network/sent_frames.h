// A configuration's picture as a device shows it whose rows come from a render server, and what they take on the way.
#pragma once
#include "sweep/sweep.h"

namespace pocketray {

struct SentPicture {
  Levels levels;
  double bytes_per_frame = kNotMeasured;  // of rows, without messages; mean of the frames after the first
};

// Renders frames of a camera that orbits its target by kSentOrbitDegrees a frame and comes to rest where the rig's is,
// at one time, and sends their rows losslessly or near-losslessly, as the configuration says. The last frame stays in
// the rig's renderer. After an interrupt *sent is meaningless.
Status send_frames(Rig* rig, const Configuration& configuration, double seconds, SentPicture* sent);

}  // namespace pocketray
