// Random numbers that nobody can foresee. Standard types only. null/null_entropy.h has foreseeable ones for tests.
#pragma once
#include <cstddef>

namespace platform {

// Fills the bytes; neither waits nor takes memory. False: the system has none to give.
bool random_bytes(void* bytes, std::size_t byte_count);

}  // namespace platform
