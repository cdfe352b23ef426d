// A set of samples of a sequence: disjoint ranges in ascending order that do not touch.
#pragma once
#include <cstdint>
#include <vector>

namespace pocketray {

struct SampleRange {
  std::uint32_t begin, end;
};
using SampleSet = std::vector<SampleRange>;

std::uint64_t sample_count(const SampleSet& set);
// Returns the parts of a range that the set lacks.
SampleSet missing_samples(const SampleSet& set, const SampleRange& range);
// Adds a range; the set must have none of it.
void add_samples(const SampleRange& range, SampleSet* set);

}  // namespace pocketray
