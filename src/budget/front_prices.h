// What the candidates of a front cost on this machine.
#pragma once
#include <vector>

#include "budget/budget.h"
#include "session/measure.h"

namespace pocketray {

struct FrontPrices {
  std::uint32_t round_count = 0;
  std::vector<double> ns_per_pixel[kFrontCandidateMax];  // one for each round; none: it takes too long to be measured
};

// Room for so many rounds; nothing allocates afterwards.
FrontPrices make_front_prices(const Front& front, std::uint32_t round_count);
// Renders whole frames, packed for a screen of 16 bits, all candidates in turn in each round, so that what befalls the
// machine befalls all of them. What would take longer than a few seconds a frame is left to follow by its stated price.
// An emulated device's times are computed, not waited for. Ends early at an interrupt; a round that it
// cuts short has times of its first candidates alone, which count, and is not counted itself.
Status measure_front(Renderer* renderer, const Front& front, FrontPrices* prices);
// What the frame arena must hold for it.
std::size_t front_prices_bytes(const Settings& settings);

// The candidates that were measured, with their medians. Sorts the prices.
Front measured_front(const Front& front, FrontPrices* prices);

}  // namespace pocketray
