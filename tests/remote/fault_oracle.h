// Frame time of the best split in a fault-free world with everything known.
#pragma once
#include "fault_plan.h"
#include "remote/client/client.h"

namespace pocketray {

// Uses the ready servers. Predicts as the product does, but from true costs of rows and link; compression is the
// client's estimate.
double best_frame_ns(const FaultPlan& plan, const Client& client);

}  // namespace pocketray
