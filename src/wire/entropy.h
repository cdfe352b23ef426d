// Size of bytes if each were coded by its frequency alone: an estimate of deflation without repetitions.
#pragma once
#include <cstdint>

namespace pocketray {

struct ByteCounts {
  std::uint32_t count[256] = {};
};

inline void count_bytes(ByteCounts* counts, std::uint32_t bytes, std::uint32_t byte_count) {
  for (; byte_count > 0; --byte_count, bytes >>= 8) ++counts->count[bytes & 255];
}

// 256 · log2(x), x ≥ 1, linear between powers of two: at most 22 too low.
inline std::uint32_t log2_fixed(std::uint32_t x) {
  std::uint32_t power = 31 - static_cast<std::uint32_t>(__builtin_clz(x));
  std::uint64_t rest = x - (std::uint64_t(1) << power);
  return power * 256 + static_cast<std::uint32_t>((rest << 8) >> power);
}

// Bits, rounded down: Σ count · log2(all / count).
inline std::uint64_t entropy_bits(const ByteCounts& counts) {
  std::uint64_t all = 0, sum = 0;
  for (std::uint32_t count : counts.count) {
    all += count;
    if (count > 0) sum += std::uint64_t(count) * log2_fixed(count);
  }
  if (all == 0) return 0;
  std::uint64_t total = all * log2_fixed(static_cast<std::uint32_t>(all));
  return total > sum ? (total - sum) >> 8 : 0;
}

}  // namespace pocketray
