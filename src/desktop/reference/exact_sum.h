// A sum of doubles that is independent of their order: an integer of 128 bits, in units of 2⁻⁶⁴.
#pragma once
#include <cmath>
#include <cstdint>

namespace pocketray {

struct ExactSum {
  std::uint64_t low = 0, high = 0;  // two's complement
};

inline void add(const ExactSum& term, ExactSum* sum) {
  std::uint64_t low = sum->low + term.low;
  sum->high += term.high + (low < term.low ? 1 : 0);
  sum->low = low;
}

// Rounds towards zero to the unit; at most 2³⁸, which leaves room for 2²⁴ terms. NaN counts as zero.
inline ExactSum exact_term(double value) {
  constexpr double kLargest = 0x1p38;
  double size = std::fabs(value);
  if (!(size > 0)) return {};
  if (size > kLargest) size = kLargest;
  double whole = std::floor(size);
  ExactSum term = {static_cast<std::uint64_t>((size - whole) * 0x1p64), static_cast<std::uint64_t>(whole)};
  if (value > 0) return term;
  term.low = ~term.low + 1;
  term.high = ~term.high + (term.low == 0 ? 1 : 0);
  return term;
}

inline double value_of(const ExactSum& sum) {
  bool negative = sum.high >> 63;
  std::uint64_t low = negative ? ~sum.low + 1 : sum.low, high = negative ? ~sum.high + (low == 0 ? 1 : 0) : sum.high;
  double size = static_cast<double>(high) + static_cast<double>(low) * 0x1p-64;
  return negative ? -size : size;
}

}  // namespace pocketray
