// A session that goes wrong, by a plan, and what has to hold in it all the same.
#pragma once
#include <cstdint>
#include <string>

#include "fault_plan.h"

namespace pocketray {

// Of one session, for the sum of all.
struct SessionResult {
  std::string failure;  // empty: none
  int frames = 0, frames_disturbed = 0, faults_struck = 0, losses = 0;
  int frames_late = 0;                         // beyond 1.05 times the device's alone
  int lies = 0;                                // found
  bool far_from_best = false;                  // in the end: frames take far longer than with the best split
  int struck[platform::kLinkFaultCount] = {};  // drawn, of sessions in which as many struck
  double worst_calm = 0, worst_disturbed = 0;  // time of a frame over the device's alone
  double worst_settled = 0;                    // over the best split's, when everything is known and nothing goes wrong
  std::uint64_t return_ns = 0;                 // till all servers were in use again
};
SessionResult run_fault_session(const FaultPlan& plan);

}  // namespace pocketray
