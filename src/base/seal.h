// The seal: while it is on, nothing allocates. Builds with POCKETRAY_SEAL_CHECK abort on a malloc under it
// (platform/linux/seal_malloc.cpp).
#pragma once
#include <atomic>

namespace pocketray {

inline std::atomic<bool> memory_sealed{false};

inline void seal_memory() { memory_sealed.store(true); }
inline void unseal_memory() { memory_sealed.store(false); }

}  // namespace pocketray
