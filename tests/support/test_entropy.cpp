#include "support/test_entropy.h"

namespace pocketray {
namespace {

std::uint64_t state = 0;

// SplitMix64 [Steele, Lea & Flood 2014, fig. 14].
std::uint64_t next() {
  std::uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

}  // namespace

void seed_test_entropy(std::uint64_t seed) { state = seed; }

bool test_random_bytes(void* bytes, std::size_t byte_count) {
  unsigned char* at = static_cast<unsigned char*>(bytes);
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < byte_count; ++i, word >>= 8) {
    if (i % 8 == 0) word = next();
    at[i] = static_cast<unsigned char>(word);
  }
  return true;
}

bool no_random_bytes(void*, std::size_t) { return false; }

}  // namespace pocketray
