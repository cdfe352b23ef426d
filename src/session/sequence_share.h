// Distributes a sequence's frames among ranks. A rank has a run of consecutive frames, since only what changes between
// frames is traced again; a rank that is done takes half of the longest remaining run.
#pragma once
#include <cstdint>
#include <vector>

namespace pocketray {

class SequenceShare {
 public:
  // The frames to render, in ascending order. Every rank begins with an equal run.
  SequenceShare(std::vector<std::uint32_t> frames, std::uint32_t rank_count);

  // Returns a rank's next frames, at most `count`; none only if no rank has any left. They stay with the rank.
  std::vector<std::uint32_t> take(std::uint32_t rank, std::uint32_t count);
  // Number of frames of all ranks not yet given out.
  std::size_t left() const;

 private:
  struct Run {
    std::size_t begin, end;  // positions in frames_
  };
  std::vector<std::uint32_t> frames_;
  std::vector<Run> runs_;  // by rank
};

}  // namespace pocketray
