#include "desktop/reference/sample_set.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {

std::uint64_t sample_count(const SampleSet& set) {
  std::uint64_t count = 0;
  for (const SampleRange& range : set) count += range.end - range.begin;
  return count;
}

SampleSet missing_samples(const SampleSet& set, const SampleRange& range) {
  SampleSet missing;
  std::uint32_t from = range.begin;
  for (const SampleRange& there : set) {
    if (there.end <= from) continue;
    if (there.begin >= range.end) break;
    if (there.begin > from) missing.push_back({from, there.begin});
    from = there.end;
  }
  if (from < range.end) missing.push_back({from, range.end});
  return missing;
}

void add_samples(const SampleRange& range, SampleSet* set) {
  CHECK_LT(range.begin, range.end);
  auto next = std::find_if(set->begin(), set->end(), [&](const SampleRange& r) { return r.begin >= range.begin; });
  CHECK(next == set->end() || range.end <= next->begin);
  CHECK(next == set->begin() || (next - 1)->end <= range.begin);
  next = set->insert(next, range);
  if (next + 1 != set->end() && (next + 1)->begin == next->end) {
    next->end = (next + 1)->end;
    next = set->erase(next + 1) - 1;
  }
  if (next == set->begin() || (next - 1)->end != next->begin) return;
  (next - 1)->end = next->end;
  set->erase(next);
}

}  // namespace pocketray
