#include "session/sequence_share.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {

SequenceShare::SequenceShare(std::vector<std::uint32_t> frames, std::uint32_t rank_count) : frames_(std::move(frames)) {
  CHECK_GE(rank_count, 1u);
  CHECK(std::is_sorted(frames_.begin(), frames_.end()));
  for (std::size_t rank = 0; rank < rank_count; ++rank)
    runs_.push_back({rank * frames_.size() / rank_count, (rank + 1) * frames_.size() / rank_count});
}

std::vector<std::uint32_t> SequenceShare::take(std::uint32_t rank, std::uint32_t count) {
  CHECK_LT(rank, runs_.size());
  Run* own = &runs_[rank];
  if (own->begin == own->end) {
    auto longest = std::max_element(runs_.begin(), runs_.end(),
                                    [](const Run& a, const Run& b) { return a.end - a.begin < b.end - b.begin; });
    const std::size_t middle = longest->begin + (longest->end - longest->begin) / 2;
    *own = {middle, longest->end};
    longest->end = middle;
  }
  const std::size_t end = std::min(own->end, own->begin + count);
  std::vector<std::uint32_t> taken(frames_.begin() + static_cast<std::ptrdiff_t>(own->begin),
                                   frames_.begin() + static_cast<std::ptrdiff_t>(end));
  own->begin = end;
  return taken;
}

std::size_t SequenceShare::left() const {
  std::size_t count = 0;
  for (const Run& run : runs_) count += run.end - run.begin;
  return count;
}

}  // namespace pocketray
