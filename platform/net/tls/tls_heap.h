// Memory of the TLS library: it asks for memory by calloc() and free() of its own, which the build turns into the two
// functions below (CMakeLists.txt). They take it from the heap in use, a fixed part of the link's memory: one for each
// stream, so that a peer can exhaust only its own. Nothing else may call them.
#pragma once
#include <cstddef>

namespace platform {

struct TlsHeap {
  unsigned char* bytes = nullptr;  // from the caller, aligned to 16
  std::size_t byte_count = 0;
  std::size_t used = 0, used_max = 0;  // bytes, headers included
  bool refused = false;                // a block found no room
};

// Places an empty heap of `byte_count` bytes, a multiple of 16, at `memory`.
TlsHeap make_tls_heap(void* memory, std::size_t byte_count);

// The heap of this thread's calls to the library while this lives.
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
// As calloc() and free(), from the heap in use. Null when it is full, or if the product overflows.
void* pocketray_tls_calloc(std::size_t count, std::size_t byte_count);
void pocketray_tls_free(void* block);
}
