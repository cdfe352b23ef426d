// Measures the prices of a front on this machine.
#pragma once
#include <vector>

#include "budget/budget.h"
#include "session/measure.h"

namespace pocketray {

struct FrontPrices {
  std::uint32_t round_count = 0;
  std::vector<double> ns_per_pixel[kFrontCandidateMax];  // one per round; empty: too slow to measure
};

// Reserves room for `round_count` rounds; measuring allocates nothing.
FrontPrices make_front_prices(const Front& front, std::uint32_t round_count);
// Renders whole frames, packed for a 16-bit screen, with all candidates in turn in each round, so that disturbances
// affect all equally. Candidates that would take more than a few seconds per frame are not measured; their stated
// prices scale with the others. An emulated device's times are computed, not waited for. Ends early at an interrupt;
// times from an unfinished round are used but the round is not counted.
Status measure_front(Renderer* renderer, const Front& front, FrontPrices* prices);
// Bytes that measure_front() needs in the frame arena.
std::size_t front_prices_bytes(const Settings& settings);

// Returns the measured candidates with their median prices. Sorts the prices in place.
Front measured_front(const Front& front, FrontPrices* prices);

}  // namespace pocketray
