// What it takes an emulated machine to code or decode rows: a time per pixel and one per byte of code, by which the
// clocks that tests/bench/device/codec_cost.py counts are described to within 10 %.
#pragma once
#include <cstdint>

namespace pocketray {

struct CodeCost {
  double pixel_ns = 0, byte_ns = 0;
};

// Rows that are not coded have no bytes of code; to copy a pixel takes no longer than pixel_ns.
inline std::uint64_t code_ns(const CodeCost& cost, std::uint64_t pixel_count, std::uint64_t code_bytes) {
  return static_cast<std::uint64_t>(cost.pixel_ns * static_cast<double>(pixel_count) +
                                    cost.byte_ns * static_cast<double>(code_bytes));
}

}  // namespace pocketray
