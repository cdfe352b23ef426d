// Predicts how long the current frame and a new one would take, to choose between them.
#pragma once
#include "remote/client/client.h"

namespace pocketray {

struct FrameOutlook {
  double left_ns = 0;  // until the current frame is complete; 0: it is
  double anew_ns = 0;  // until one begun now would be, or its coarse picture, if this one had any; 0: unknown
};

// While the frame is within its predicted time, the prediction holds. After that, a server that is late by some time is
// assumed to be late by as much again before it continues as predicted: the longer its silence, the longer its rows
// take. The device helps with them. A new frame takes its predicted time, after the chunk each server may be sending.
FrameOutlook outlook_of(const Client& client);

}  // namespace pocketray
