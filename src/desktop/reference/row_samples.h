// Samples of one row, separate from their accumulation: the message between programs that share a reference.
#pragma once
#include "desktop/reference/accumulation.h"

namespace pocketray {

struct RowSamples {
  std::uint32_t row;
  SampleRange samples;         // per half
  std::vector<ExactSum> sums;  // R, G, B of each pixel of the first half, then of the second
};

// Takes the samples of a row of the reference's frame. Threads may call it concurrently.
RowSamples take_row(const Reference& reference, Transport transport, std::uint32_t row, const SampleRange& samples);

// Adds the samples. Fails, adding nothing, if the sizes differ or the accumulation already has one of them.
Status merge(const RowSamples& taken, Accumulation* accumulation);

}  // namespace pocketray
