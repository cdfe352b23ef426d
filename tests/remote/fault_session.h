// A session with planned faults, and the properties that must still hold.
#pragma once
#include <cstdint>
#include <string>

#include "fault_plan.h"

namespace pocketray {

// Result of one session, to be summed over all.
struct SessionResult {
  std::string failure;  // empty: none
  int frames = 0, frames_disturbed = 0, faults_struck = 0, losses = 0;
  int frames_late = 0;  // over 1.05 times the device's time alone
  int lies = 0;         // found
  // Frames that equal the last one, of which nothing is requested; in which the device kept pixels, or a server did.
  int unchanged = 0, device_kept = 0, server_kept = 0;
  int by_effect = 0, lit = 0;                  // frames shared so, and those with a server's light
  bool far_from_best = false;                  // at the end, frames take far longer than with the best split
  int struck[platform::kLinkFaultCount] = {};  // faults drawn, in sessions where all struck
  double worst_calm = 0, worst_disturbed = 0;  // frame time relative to the device's alone
  double worst_settled = 0;                    // relative to the best split, with everything known and no faults
  std::uint64_t return_ns = 0;                 // until all servers were in use again
};
SessionResult run_fault_session(const FaultPlan& plan);

}  // namespace pocketray
