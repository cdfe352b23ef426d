// A configuration's picture as shown by a device whose rows come from a render server, and their size on the wire.
#pragma once
#include "desktop/sweep/sweep.h"

namespace pocketray {

struct SentPicture {
  Levels levels;
  double bytes_per_frame = kNotMeasured;  // of rows, without messages; mean over the frames after the first
};

// Renders frames with a camera that orbits its target by kSentOrbitDegrees per frame and ends at the rig's, at a fixed
// time, and sends their rows losslessly or near-losslessly, as configured. The last frame stays in the rig's renderer.
// After an interrupt *sent is meaningless.
Status send_frames(Rig* rig, const Configuration& configuration, double seconds, SentPicture* sent);

}  // namespace pocketray
