// Rows with different costs on an emulated CPU, for simulations.
#pragma once
#include <cstdint>

#include "engine/pace.h"

namespace pocketray {

// The pace for rendering these rows. `row_costs`: each picture row's cost relative to the mean; null: all equal.
inline Pace pace_of_rows(Pace pace, const float* row_costs, std::uint32_t row_begin, std::uint32_t row_end) {
  if (!row_costs || row_begin >= row_end) return pace;
  double sum = 0;
  for (std::uint32_t row = row_begin; row < row_end; ++row) sum += static_cast<double>(row_costs[row]);
  pace.ns_per_pixel *= sum / (row_end - row_begin);
  return pace;
}

}  // namespace pocketray
