// Random numbers of the system.
#include "platform/entropy.h"

#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <set>

// Goal: bytes that differ each time and reach every value; nothing is written behind them. Method: 4096 words.
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
