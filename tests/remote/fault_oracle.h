// What the best split of a frame takes in a fault world at peace, of which everything is known.
#pragma once
#include "fault_plan.h"
#include "remote/client/client.h"

namespace pocketray {

// Of servers that are ready. Predicted as the product does, from the true costs of rows and link; what rows compress to
// is the client's.
double best_frame_ns(const FaultPlan& plan, const Client& client);

}  // namespace pocketray
