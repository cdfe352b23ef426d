// Random numbers of the system, and those for tests.
#include "platform/entropy.h"

#include <doctest/doctest.h>

#include <cstring>
#include <set>

#include "platform/null/null_entropy.h"

// Goal: bytes differ each time and take every value; nothing is written after them. Method: 4096 words.
TEST_CASE("entropy_words_do_not_repeat") {
  std::set<std::uint64_t> words;
  std::set<unsigned> values;
  for (int i = 0; i < 4096; ++i) {
    unsigned char bytes[12];
    std::memset(bytes, 0x5a, sizeof bytes);
    REQUIRE(platform::random_bytes(bytes, 8));
    std::uint64_t word;
    std::memcpy(&word, bytes, sizeof word);
    words.insert(word);
    for (int k = 0; k < 8; ++k) values.insert(bytes[k]);
    for (int k = 8; k < 12; ++k) CHECK(bytes[k] == 0x5a);
  }
  CHECK(words.size() == 4096);
  CHECK(values.size() == 256);
  CHECK(platform::random_bytes(nullptr, 0));
}

// Goal: a seed determines the numbers for tests. Method: equal and unequal seeds.
TEST_CASE("null_entropy_follows_its_seed") {
  unsigned char a[20], b[20], c[20];
  platform::seed_null_entropy(7);
  REQUIRE(platform::null_random_bytes(a, sizeof a));
  REQUIRE(platform::null_random_bytes(c, sizeof c));
  platform::seed_null_entropy(7);
  REQUIRE(platform::null_random_bytes(b, sizeof b));
  CHECK(std::memcmp(a, b, sizeof a) == 0);
  CHECK(std::memcmp(a, c, sizeof a) != 0);
  platform::seed_null_entropy(8);
  REQUIRE(platform::null_random_bytes(b, sizeof b));
  CHECK(std::memcmp(a, b, sizeof a) != 0);
  CHECK(!platform::no_random_bytes(a, sizeof a));
}
