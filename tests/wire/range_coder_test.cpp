// The range coder and the code of numbers, against entropies and each other.
#include "wire/range_coder.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "base/rng.h"
#include "support/effort.h"
#include "wire/pixel_model.h"

using namespace pocketray;

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Bit {
  std::uint32_t model, value;
};

// Bits of 8 models; the bits of model k are 1 once in 2^k.
std::vector<Bit> some_bits(Rng* rng, std::uint32_t count) {
  std::vector<Bit> bits(count);
  for (Bit& bit : bits) {
    bit.model = next_u32(rng) % 8;
    bit.value = (next_u32(rng) & ((1u << bit.model) - 1)) == 0;
  }
  return bits;
}

}  // namespace

// Goal: the decoder returns the bits, adapting and even ones, for any length, and reads all bytes. Method: random
// sequences; each code again with a capacity of its length, and a byte less.
TEST_CASE("range_coder_round_trip") {
  Rng rng = make_rng(1);
  for (int round = 0; round < effort(3000); ++round) {
    const std::vector<Bit> bits = some_bits(&rng, next_u32(&rng) % 400);
    auto encode = [&](std::size_t capacity, Bytes* bytes) {
      *bytes = Bytes(capacity);
      RangeEncoder coder(bytes->data(), capacity);
      Probability models[8];
      for (Probability& p : models) p = kEven;
      for (const Bit& bit : bits)
        bit.model == 0 ? coder.even_bits(bit.value * 5, 3) : coder.bit(&models[bit.model], bit.value);
      bytes->resize(coder.finish());
      return !coder.overflows();
    };
    Bytes bytes, again;
    REQUIRE(encode(2000, &bytes));
    if (!bytes.empty()) REQUIRE(bytes.back() != 0);
    RangeDecoder decoder(bytes.data(), bytes.size());
    Probability models[8];
    for (Probability& p : models) p = kEven;
    for (const Bit& bit : bits)
      REQUIRE((bit.model == 0 ? decoder.even_bits(0, 3) / 5 : decoder.bit(&models[bit.model], 0)) == bit.value);
    REQUIRE(decoder.is_at_end());
    REQUIRE(encode(bytes.size(), &again));
    REQUIRE(again == bytes);
    if (!bytes.empty()) REQUIRE(!encode(bytes.size() - 1, &again));
  }
}

// Goal: carries reach bytes already held back. Method: a first bit that leaves a range whose bytes are FF FF …, then a
// bit that carries; compared with the same numbers in 128 bits would be the same code, so the decoder judges.
TEST_CASE("range_coder_carries") {
  int carried = 0;
  for (std::uint32_t pattern = 0; pattern < 4096; ++pattern) {
    std::uint8_t bytes[64];
    RangeEncoder coder(bytes, sizeof bytes);
    // Even bits 1 push `low` to the top of the range, where bytes of ones wait for a carry.
    coder.even_bits(~0u >> 2, 30);
    for (std::uint32_t i = 0; i < 12; ++i) {
      Probability p = static_cast<Probability>(15 + 4066 * (pattern >> i & 1));
      coder.bit(&p, pattern >> (11 - i) & 1);
    }
    const std::size_t count = coder.finish();
    REQUIRE(!coder.overflows());
    RangeDecoder decoder(bytes, count);
    REQUIRE(decoder.even_bits(0, 30) == ~0u >> 2);
    for (std::uint32_t i = 0; i < 12; ++i) {
      Probability p = static_cast<Probability>(15 + 4066 * (pattern >> i & 1));
      REQUIRE(decoder.bit(&p, 0) == (pattern >> (11 - i) & 1));
    }
    carried += bytes[0] != 0xFF;
  }
  CHECK(carried < 4096);
}

// Goal: bits take about their entropy. Method: bits that are 1 with a known probability, 2⁻¹ to 2⁻⁷; adaptation costs a
// few percent, as many as 15 for rare bits, and no bit takes less than a 189th of a bit (of 15/4096).
TEST_CASE("range_coder_takes_the_entropy") {
  for (std::uint32_t k = 1; k < 8; ++k) {
    Rng rng = make_rng(k);
    constexpr std::uint32_t kCount = 100000;
    Bytes bytes(kCount);
    RangeEncoder coder(bytes.data(), bytes.size());
    Probability p = kEven;
    for (std::uint32_t i = 0; i < kCount; ++i) coder.bit(&p, (next_u32(&rng) & ((1u << k) - 1)) == 0);
    const double x = std::ldexp(1.0, -static_cast<int>(k));
    const double entropy = -1.0 * kCount * (x * std::log2(x) + (1 - x) * std::log2(1 - x)) / 8;
    const double taken = static_cast<double>(coder.finish());
    CAPTURE(k);
    CHECK(taken > 0.99 * entropy);
    CHECK(taken < 1.2 * entropy);
  }
}

// Goal: numbers of all sizes come back.
TEST_CASE("code_number_round_trip") {
  for (std::uint32_t bits : {1u, 2u, 5u, 6u, 8u}) {
    Bytes bytes(4000);
    CodeModels models;
    restart_models(&models);
    RangeEncoder coder(bytes.data(), bytes.size());
    for (std::uint32_t value = 1; value < 1u << bits; ++value)
      CHECK(code_number(&coder, &models.block.motion[0], bits, value) == value);
    const std::size_t count = coder.finish();
    restart_models(&models);
    RangeDecoder decoder(bytes.data(), count);
    for (std::uint32_t value = 1; value < 1u << bits; ++value)
      CHECK(code_number(&decoder, &models.block.motion[0], bits, 0) == value);
  }
}
