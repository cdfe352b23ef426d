// Random bytes in place of the system's: the same every time, from a seed.
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

void seed_test_entropy(std::uint64_t seed);
// As random_bytes() of platform/entropy.h.
bool test_random_bytes(void* bytes, std::size_t byte_count);
// A system that has none.
bool no_random_bytes(void* bytes, std::size_t byte_count);

}  // namespace pocketray
