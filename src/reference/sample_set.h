// Which samples of a sequence are there: disjoint ranges in ascending order that do not touch.
#pragma once
#include <cstdint>
#include <vector>

namespace pocketray {

struct SampleRange {
  std::uint32_t begin, end;
};
using SampleSet = std::vector<SampleRange>;

std::uint64_t sample_count(const SampleSet& set);
// The parts of a range that the set lacks.
SampleSet missing_samples(const SampleSet& set, const SampleRange& range);
// Adds a range, none of which the set has.
void add_samples(const SampleRange& range, SampleSet* set);

}  // namespace pocketray
