// Which frames of a sequence each rank renders. A rank has a run of neighbouring frames, since what changes little from
// one to the next is traced again only where it changes; one that is through takes half of the longest run left.
#pragma once
#include <cstdint>
#include <vector>

namespace pocketray {

class SequenceShare {
 public:
  // The frames to render, in ascending order. Every rank begins with an equal run.
  SequenceShare(std::vector<std::uint32_t> frames, std::uint32_t rank_count);

  // The next frames of a rank, at most so many; none only if none is left of any. What is given out stays its own.
  std::vector<std::uint32_t> take(std::uint32_t rank, std::uint32_t count);
  // Of all ranks, not given out yet.
  std::size_t left() const;

 private:
  struct Run {
    std::size_t begin, end;  // positions in frames_
  };
  std::vector<std::uint32_t> frames_;
  std::vector<Run> runs_;  // by rank
};

}  // namespace pocketray
