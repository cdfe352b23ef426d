#include "scene/content_hash.h"

#include <doctest/doctest.h>

#include <cstring>
#include <set>
#include <utility>
#include <vector>

#include "base/rng.h"

using namespace pocketray;

// Goal: the hash is MurmurHash3_x64_128. Method: published values.
TEST_CASE("content_hash_known_values") {
  const char* text = "The quick brown fox jumps over the lazy dog";
  ContentHash hash = content_hash(text, std::strlen(text));
  CHECK(hash.low == 0xe34bbc7bbc071b6cull);
  CHECK(hash.high == 0x7a433ca9c49a9347ull);
  CHECK(content_hash("", 0) == ContentHash());
}

// Goal: every byte and the length count. Method: all prefixes of 100 bytes and each of their single-bit neighbours.
TEST_CASE("content_hash_depends_on_every_bit") {
  Rng rng = make_rng(3);
  std::vector<std::uint8_t> bytes(100);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(next_u32(&rng));
  std::set<std::pair<std::uint64_t, std::uint64_t>> seen;
  std::size_t count = 0;
  auto add = [&](std::size_t length) {
    ContentHash hash = content_hash(bytes.data(), length);
    seen.insert({hash.low, hash.high}), ++count;
  };
  for (std::size_t length = 0; length <= bytes.size(); ++length) {
    add(length);
    if (length % 7 != 0 && length != 100) continue;
    for (std::size_t bit = 0; bit < 8 * length; ++bit) {
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
      add(length);
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    }
  }
  CHECK(seen.size() == count);
}
