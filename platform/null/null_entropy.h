// Random numbers for tests: the same ones every time, from a seed.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

void seed_null_entropy(std::uint64_t seed);
// The same as random_bytes() of entropy.h.
bool null_random_bytes(void* bytes, std::size_t byte_count);
// A system without random numbers.
bool no_random_bytes(void* bytes, std::size_t byte_count);

}  // namespace platform
