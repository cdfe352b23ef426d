// Unpredictable random numbers. Standard types only. tests/support/test_entropy.h has predictable ones.
#pragma once
#include <cstddef>

namespace platform {

// Fills the bytes; neither waits nor takes memory. Returns false if the system cannot supply any.
bool random_bytes(void* bytes, std::size_t byte_count);

}  // namespace platform
