// How long the frame under way and a new one would take, for those who must choose between them.
#pragma once
#include "remote/client/client.h"

namespace pocketray {

struct FrameOutlook {
  double left_ns = 0;  // until the frame under way is complete; 0: it is
  double anew_ns = 0;  // until one begun now would be, or its coarse picture, if this one had any; 0: unknown
};

// While the frame is within its predicted time, that counts. Then a server that is late by some time is taken to be
// late by as much again before it goes on as predicted: the longer it is silent, the longer its rows take. The device
// helps with them. A new frame takes its predicted time, after the chunk that each server may be sending.
FrameOutlook outlook_of(const Client& client);

}  // namespace pocketray
