// Samples of one row apart from their accumulation: what programs that share a reference send each other.
#pragma once
#include "reference/accumulation.h"

namespace pocketray {

struct RowSamples {
  std::uint32_t row;
  SampleRange samples;         // of each half
  std::vector<ExactSum> sums;  // R, G, B of each pixel of the first half, then of the second
};

// Takes the samples of a row of the reference's frame. Threads may do so at once.
RowSamples take_row(const Reference& reference, Transport transport, std::uint32_t row, const SampleRange& samples);

// Adds them. Fails, with nothing added, if they are not of the accumulation's size or it has one of them.
Status merge(const RowSamples& taken, Accumulation* accumulation);

}  // namespace pocketray
