#include "scene/checksum.h"

#include <cstring>

#include "base/check.h"

#if defined(__ARM_NEON)
#include <arm_neon.h>
#elif defined(__x86_64__)
#include <immintrin.h>

#include "base/isa.h"
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

#if defined(__x86_64__)
__attribute__((target("avx2"))) void add_stripes_avx2(const std::uint8_t* bytes, std::size_t stripe_count,
                                                      std::uint32_t (&lanes)[8]) {
  const __m256i odd = _mm256_set1_epi32(static_cast<int>(kOdd));
  __m256i h = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(lanes));
  for (; stripe_count > 0; --stripe_count, bytes += kStripeBytes) {
    const __m256i turned = _mm256_or_si256(_mm256_slli_epi32(h, kTurn), _mm256_srli_epi32(h, 32 - kTurn));
    const __m256i words = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes));
    h = _mm256_mullo_epi32(_mm256_add_epi32(words, turned), odd);
  }
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(lanes), h);
}
#endif

}  // namespace

std::uint32_t block_sum(const std::uint8_t* bytes, std::size_t byte_count) {
  CHECK(bytes != nullptr || byte_count == 0);
  CHECK_EQ(reinterpret_cast<std::uintptr_t>(bytes) % 4, 0u);
  std::uint32_t lanes[8] = {1, 2, 3, 4, 5, 6, 7, 8};
  const std::size_t stripe_count = byte_count / kStripeBytes, rest = byte_count % kStripeBytes;
#if defined(__x86_64__)
  if (active_isa() != Isa::kBaseline)
    add_stripes_avx2(bytes, stripe_count, lanes);
  else
#endif
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

std::uint32_t joined_sum(const std::uint8_t* bytes, std::size_t begin, std::size_t byte_count,
                         const ParallelLoop& loop) {
  CHECK_LE(begin, byte_count);
  CHECK_LT(begin, kChecksumBlockBytes);
  constexpr std::size_t kGroupSize = 256;  // chosen: blocks whose sums are kept
  std::uint32_t sum = 0, sums[kGroupSize];
  const std::size_t block_count = begin < byte_count ? (byte_count - 1) / kChecksumBlockBytes + 1 : 0;
  for (std::size_t group = 0; group < block_count; group += kGroupSize) {
    auto sum_up = [&](std::uint32_t i) {
      const std::size_t at = (group + i) * kChecksumBlockBytes, first = at < begin ? begin : at;
      const std::size_t left = byte_count - at, end = at + (left < kChecksumBlockBytes ? left : kChecksumBlockBytes);
      sums[i] = block_sum(bytes + first, end - first);
    };
    const std::size_t count = block_count - group < kGroupSize ? block_count - group : kGroupSize;
    run_loop(loop, static_cast<std::uint32_t>(count), sum_up);
    for (std::size_t i = 0; i < count; ++i) sum = join_sums(sum, sums[i]);
  }
  return sum;
}

}  // namespace pocketray
