// A reference whose samples all ranks of a team take. The leader gives out pieces, rows of some samples each, and adds
// what comes back; so it always has all that is finished, and may save or stop at any time.
#pragma once
#include "sweep/reference_gauge.h"

namespace pocketray {

// For the leader: takes the samples that the goal lacks, with its own threads and the helpers, until enough or
// interrupted. Afterwards all helpers are idle. Fails if one of them has.
Status take_with_team(const ReferenceGoal& goal, Rig* rig, Accumulation* accumulation, ReferenceGauge* gauge);

// For the others. `rig` and `options` must outlive it.
class ReferenceHelper {
 public:
  // Finds the rig, prepared for references, when the leader begins the first one.
  using FindRig = std::function<Status(Rig** rig)>;
  ReferenceHelper(const Team& team, const AccuracyOptions& options, FindRig find_rig)
      : team_(team), options_(options), find_rig_(std::move(find_rig)) {}

  // Does what a message of the leader asks for. Fails if this rank's samples are not those of the leader's scene.
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
