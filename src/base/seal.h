// The seal: while it is on, nothing allocates. Builds with POCKETRAY_SEALED_HEAP link tests/support/seal_malloc.cpp,
// which aborts on any malloc under the seal.
#pragma once
#include <atomic>

namespace pocketray {

inline std::atomic<bool> memory_sealed{false};

inline void seal_memory() { memory_sealed.store(true); }
inline void unseal_memory() { memory_sealed.store(false); }

// Lifts the seal, if it is on, for work that a device never does.
class SealPause {
 public:
  explicit SealPause(bool needed = true) : paused_(needed && memory_sealed) {
    if (paused_) unseal_memory();
  }
  ~SealPause() {
    if (paused_) seal_memory();
  }
  SealPause(const SealPause&) = delete;
  SealPause& operator=(const SealPause&) = delete;

 private:
  bool paused_;
};

}  // namespace pocketray
