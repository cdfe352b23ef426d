// Memory of the TLS library, whose calls of calloc() and free() the build redirects to the two functions below
// (CMakeLists.txt). They use the current heap, a fixed part of the link's memory: one per stream, so that a peer can
// exhaust only its own. Nothing else may call them.
#pragma once
#include <cstddef>

namespace platform {

struct TlsHeap {
  unsigned char* bytes = nullptr;  // from the caller, aligned to 16
  std::size_t byte_count = 0;
  std::size_t used = 0, used_max = 0;  // bytes, headers included
  bool refused = false;                // an allocation found no room
};

// Places an empty heap of `byte_count` bytes, a multiple of 16, at `memory`.
TlsHeap make_tls_heap(void* memory, std::size_t byte_count);

// Selects the heap for this thread's calls to the library during its lifetime.
class TlsHeapUse {
 public:
  explicit TlsHeapUse(TlsHeap* heap);
  ~TlsHeapUse();
  TlsHeapUse(const TlsHeapUse&) = delete;
  TlsHeapUse& operator=(const TlsHeapUse&) = delete;

 private:
  TlsHeap* before_;
};

}  // namespace platform

extern "C" {
// calloc() and free() on the current heap. Null if it is full, or if the product overflows.
void* pocketray_tls_calloc(std::size_t count, std::size_t byte_count);
void pocketray_tls_free(void* block);
}
