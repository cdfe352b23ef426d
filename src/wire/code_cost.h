// Cost of coding and decoding rows on an emulated machine: a time per pixel and one per byte of code. Fits the cycle
// counts of tests/bench/device/codec_cost.py to within 10 %.
#pragma once
#include <cstdint>

namespace pocketray {

struct CodeCost {
  double pixel_ns = 0, byte_ns = 0;
};

// Uncoded rows have no bytes of code; copying a pixel takes at most pixel_ns.
inline std::uint64_t code_ns(const CodeCost& cost, std::uint64_t pixel_count, std::uint64_t code_bytes) {
  return static_cast<std::uint64_t>(cost.pixel_ns * static_cast<double>(pixel_count) +
                                    cost.byte_ns * static_cast<double>(code_bytes));
}

}  // namespace pocketray
