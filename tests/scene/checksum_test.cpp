// The checksum of .pray files.
#include "scene/checksum.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "base/isa.h"
#include "base/rng.h"
#include "scene/baked_file.h"
#include "scene/baked_layout.h"

using namespace pocketray;

namespace {

// Bytes that begin at a multiple of 64, and no more, so that a sanitizer sees reads beyond them.
BakedFile random_bytes(std::size_t count, std::uint64_t seed) {
  BakedFile bytes(count);
  Rng rng = make_rng(seed);
  for (std::size_t i = 0; i < count; ++i) bytes.data()[i] = static_cast<std::uint8_t>(next_u32(&rng));
  return bytes;
}

// As the format defines it, byte by byte.
struct Definition {
  static std::uint32_t step(std::uint64_t h, std::uint64_t word) {
    const std::uint64_t turned = (h << 13 | h >> 19) & 0xFFFFFFFFu;
    return static_cast<std::uint32_t>((word + turned) * 2654435761u);
  }
  static std::uint32_t join(std::uint32_t before, std::uint32_t sum) {
    const std::uint32_t h = step(before, sum);
    return h ^ h >> 15;
  }
  static std::uint32_t block(const std::uint8_t* bytes, std::size_t count) {
    std::uint32_t lanes[8] = {1, 2, 3, 4, 5, 6, 7, 8}, sum = 0;
    for (std::size_t at = 0; at < (count + 31) / 32 * 32; at += 4) {
      std::uint32_t word = 0;
      for (std::size_t i = 4; i-- > 0;) word = word << 8 | (at + i < count ? bytes[at + i] : 0u);
      lanes[at / 4 % 8] = step(lanes[at / 4 % 8], word);
    }
    for (std::uint32_t lane : lanes) sum = join(sum, lane);
    return sum;
  }
};

}  // namespace

// Goal: block_sum() and join_sums() are what files of version 21 hold, on every CPU. Method: the definition, byte by
// byte, for every length up to a few stripes; and known sums.
TEST_CASE("checksum_of_a_block_is_as_defined") {
  for (int isa = 0; isa <= static_cast<int>(best_isa()); ++isa) {
    select_isa(static_cast<Isa>(isa));
    for (std::size_t count = 0; count <= 200; ++count) {
      CAPTURE(count);
      const BakedFile bytes = random_bytes(count, 400 + count);
      CHECK(block_sum(bytes.data(), count) == Definition::block(bytes.data(), count));
    }
  }
  std::uint8_t counting[100];
  for (std::uint32_t i = 0; i < 100; ++i) counting[i] = static_cast<std::uint8_t>(i);
  alignas(4) std::uint8_t aligned[100];
  std::memcpy(aligned, counting, 100);
  CHECK(block_sum(aligned, 0) == 420980582u);
  CHECK(block_sum(aligned, 100) == 3057047639u);
  CHECK(join_sums(block_sum(aligned, 100), 7) == Definition::join(Definition::block(counting, 100), 7));
}

// Goal: the sum of a file is that of its blocks in order. Method: lengths around multiples of a block.
TEST_CASE("checksum_of_a_file_joins_blocks_from_its_start") {
  const std::size_t block = kChecksumBlockBytes;
  for (std::size_t count :
       {std::size_t(16), std::size_t(17), block - 1, block, block + 1, 2 * block, 2 * block + 100}) {
    CAPTURE(count);
    const BakedFile bytes = random_bytes(count, 401);
    std::uint32_t expected = 0;
    for (std::size_t at = 0; at < count; at += block) {
      const std::size_t begin = at == 0 ? 16 : at, end = std::min(count, at + block);
      if (begin < end) expected = Definition::join(expected, Definition::block(bytes.data() + begin, end - begin));
    }
    CHECK(joined_sum(bytes.data(), 16, count) == expected);
    CHECK(baked_checksum(kJoinedSumVersion, bytes.data(), count) == expected);
  }
}

// Goal: threads do not change the sum. Method: a loop that takes its items backwards; more blocks than a group has.
TEST_CASE("checksum_does_not_depend_on_the_order_of_blocks") {
  const std::size_t count = 300 * kChecksumBlockBytes - 4;
  const BakedFile bytes = random_bytes(count, 404);
  int taken = 0;
  const ParallelLoop backwards = {
      [](void* threads, std::uint32_t item_count, void (*take)(void* context, std::uint32_t item), void* context) {
        while (item_count-- > 0) take(context, item_count), ++*static_cast<int*>(threads);
      },
      &taken};
  CHECK(joined_sum(bytes.data(), 16, count, backwards) == joined_sum(bytes.data(), 16, count));
  CHECK(taken == 300);
}

// Goal: damage of the kinds that disks and links do changes the sum. Method: a word replaced, two bits flipped in words
// of one lane, also both topmost, stripes and blocks exchanged, a run cleared.
TEST_CASE("checksum_detects_damage") {
  const std::size_t count = 3 * kChecksumBlockBytes;
  const BakedFile bytes = random_bytes(count, 402);
  const std::uint32_t sound = joined_sum(bytes.data(), 16, count);
  Rng rng = make_rng(403);
  auto is_missed = [&](auto damage) {
    BakedFile copy(count);
    std::memcpy(copy.data(), bytes.data(), count);
    damage(copy.data());
    return joined_sum(copy.data(), 16, count) == sound;
  };
  auto place = [&] { return 16 + 4 * std::size_t(next_u32(&rng) % ((count - 16) / 4 - 64)); };
  int missed = 0;
  for (int i = 0; i < 200; ++i) {
    const std::size_t at = place(), bit = next_u32(&rng) % 32, stripes = 32 * (1 + next_u32(&rng) % 7);
    const std::uint32_t word = next_u32(&rng);
    missed += is_missed([&](std::uint8_t* b) { std::memcpy(b + at, &word, 4); });
    for (std::size_t which : {bit, std::size_t(31)})
      missed += is_missed([&](std::uint8_t* b) {
        for (std::size_t there : {at, at + stripes}) b[there + which / 8] ^= static_cast<std::uint8_t>(1 << which % 8);
      });
    missed += is_missed([&](std::uint8_t* b) { std::swap_ranges(b + at, b + at + 32, b + at + 32); });
    missed += is_missed([&](std::uint8_t* b) { std::memset(b + at, 0, stripes); });
  }
  missed += is_missed([&](std::uint8_t* b) {
    std::swap_ranges(b + kChecksumBlockBytes, b + 2 * kChecksumBlockBytes, b + 2 * kChecksumBlockBytes);
  });
  CHECK(missed == 0);
}
