// A reference whose samples all ranks of a team take. The leader gives out pieces, rows of some samples each, and adds
// the results; so it always holds everything finished, and may save or stop at any time.
#pragma once
#include "desktop/sweep/reference_gauge.h"

namespace pocketray {

// For the leader: takes the samples that the goal lacks, with its own threads and the helpers, until done or
// interrupted. Afterwards all helpers are idle. Fails if one of them did.
Status take_with_team(const ReferenceGoal& goal, Rig* rig, Accumulation* accumulation, ReferenceGauge* gauge);

// For the other ranks. `rig` and `options` must outlive it.
class ReferenceHelper {
 public:
  // Finds the rig, prepared for references, when the leader begins the first one.
  using FindRig = std::function<Status(Rig** rig)>;
  ReferenceHelper(const Team& team, const AccuracyOptions& options, FindRig find_rig)
      : team_(team), options_(options), find_rig_(std::move(find_rig)) {}

  // Does what the leader's message requests. Fails if this rank's samples are not from the leader's scene.
  Status work(const TeamMessage& message);

 private:
  Status begin(const TeamMessage& message);
  Status take_pieces(const TeamMessage& message);

  const Team& team_;
  const AccuracyOptions& options_;
  FindRig find_rig_;
  Rig* rig_ = nullptr;
  std::uint64_t run_ = 0;
  Transport transport_ = Transport::physical;
};

}  // namespace pocketray
