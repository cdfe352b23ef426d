#include "scene/checksum.h"

#include <cstring>

#include "base/check.h"

#if defined(__ARM_NEON)
#include <arm_neon.h>
#endif

namespace pocketray {
namespace {

constexpr std::uint32_t kOdd = 0x9E3779B1u;  // xxHash32's first prime
constexpr int kTurn = 13;

constexpr std::size_t kStripeBytes = 32;

std::uint32_t step(std::uint32_t h, std::uint32_t word) { return (word + (h << kTurn | h >> (32 - kTurn))) * kOdd; }

#if defined(__ARM_NEON)
uint32x4_t load(const std::uint8_t* bytes) {
  return vld1q_u32(reinterpret_cast<const std::uint32_t*>(__builtin_assume_aligned(bytes, 4)));
}
uint32x4_t step(uint32x4_t h, uint32x4_t words) {
  return vmulq_n_u32(vaddq_u32(words, vsriq_n_u32(vshlq_n_u32(h, kTurn), h, 32 - kTurn)), kOdd);
}

void add_stripes(const std::uint8_t* bytes, std::size_t stripe_count, std::uint32_t (&lanes)[8]) {
  uint32x4_t low = vld1q_u32(lanes), high = vld1q_u32(lanes + 4);
  for (; stripe_count > 0; --stripe_count, bytes += kStripeBytes)
    low = step(low, load(bytes)), high = step(high, load(bytes + 16));
  vst1q_u32(lanes, low);
  vst1q_u32(lanes + 4, high);
}
#else
std::uint32_t load(const std::uint8_t* bytes) {
  std::uint32_t word;
  std::memcpy(&word, __builtin_assume_aligned(bytes, 4), sizeof word);
  return word;
}

void add_stripes(const std::uint8_t* bytes, std::size_t stripe_count, std::uint32_t (&lanes)[8]) {
  std::uint32_t a = lanes[0], b = lanes[1], c = lanes[2], d = lanes[3];
  std::uint32_t e = lanes[4], f = lanes[5], g = lanes[6], h = lanes[7];
  for (; stripe_count > 0; --stripe_count, bytes += kStripeBytes) {
    a = step(a, load(bytes)), b = step(b, load(bytes + 4)), c = step(c, load(bytes + 8)), d = step(d, load(bytes + 12));
    e = step(e, load(bytes + 16)), f = step(f, load(bytes + 20));
    g = step(g, load(bytes + 24)), h = step(h, load(bytes + 28));
  }
  const std::uint32_t all[8] = {a, b, c, d, e, f, g, h};
  std::memcpy(lanes, all, sizeof lanes);
}
#endif

}  // namespace

std::uint32_t block_sum(const std::uint8_t* bytes, std::size_t byte_count) {
  CHECK(bytes != nullptr || byte_count == 0);
  CHECK_EQ(reinterpret_cast<std::uintptr_t>(bytes) % 4, 0u);
  std::uint32_t lanes[8] = {1, 2, 3, 4, 5, 6, 7, 8};
  const std::size_t stripe_count = byte_count / kStripeBytes, rest = byte_count % kStripeBytes;
  add_stripes(bytes, stripe_count, lanes);
  if (rest > 0) {
    alignas(16) std::uint8_t last[kStripeBytes] = {};
    std::memcpy(last, bytes + stripe_count * kStripeBytes, rest);
    add_stripes(last, 1, lanes);
  }
  std::uint32_t sum = 0;
  for (std::uint32_t lane : lanes) sum = join_sums(sum, lane);
  return sum;
}

std::uint32_t join_sums(std::uint32_t before, std::uint32_t sum) {
  const std::uint32_t h = step(before, sum);
  return h ^ h >> 15;
}

std::uint32_t joined_sum(const std::uint8_t* bytes, std::size_t begin, std::size_t byte_count) {
  CHECK_LE(begin, byte_count);
  CHECK_LT(begin, kChecksumBlockBytes);
  std::uint32_t sum = 0;
  for (std::size_t end; begin < byte_count; begin = end) {
    end = begin / kChecksumBlockBytes * kChecksumBlockBytes + kChecksumBlockBytes;
    if (end > byte_count || end < begin) end = byte_count;
    sum = join_sums(sum, block_sum(bytes + begin, end - begin));
  }
  return sum;
}

}  // namespace pocketray
