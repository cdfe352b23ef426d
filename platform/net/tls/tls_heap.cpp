#include "platform/net/tls/tls_heap.h"

#include <cstdint>
#include <cstring>

#include "platform/check.h"

namespace platform {
namespace {

constexpr std::size_t kGrain = 16;

// Header of every block, free or not; the blocks fill the heap without gaps.
struct alignas(kGrain) BlockHead {
  std::size_t byte_count;  // with this header
  std::size_t is_free;     // 0 or 1
};
static_assert(sizeof(BlockHead) == kGrain, "a header takes one grain");

thread_local TlsHeap* heap_in_use = nullptr;

BlockHead* head_at(TlsHeap* heap, std::size_t offset) { return reinterpret_cast<BlockHead*>(heap->bytes + offset); }

// Merges a free block with the free blocks behind it.
void join_free(TlsHeap* heap, std::size_t offset) {
  BlockHead* head = head_at(heap, offset);
  for (;;) {
    std::size_t next = offset + head->byte_count;
    PLATFORM_CHECK_LE(next, heap->byte_count);
    if (next == heap->byte_count || !head_at(heap, next)->is_free) return;
    head->byte_count += head_at(heap, next)->byte_count;
  }
}

// Returns the first free block that is large enough: a stream has a dozen blocks, so a search by address is quick.
void* take_block(TlsHeap* heap, std::size_t byte_count) {
  const std::size_t wanted = (byte_count + kGrain - 1) / kGrain * kGrain + sizeof(BlockHead);
  for (std::size_t offset = 0; offset < heap->byte_count; offset += head_at(heap, offset)->byte_count) {
    BlockHead* head = head_at(heap, offset);
    if (!head->is_free) continue;
    join_free(heap, offset);
    if (head->byte_count < wanted) continue;
    if (head->byte_count > wanted) {
      BlockHead* rest = head_at(heap, offset + wanted);
      rest->byte_count = head->byte_count - wanted;
      rest->is_free = 1;
      head->byte_count = wanted;
    }
    head->is_free = 0;
    heap->used += wanted;
    if (heap->used > heap->used_max) heap->used_max = heap->used;
    std::memset(head + 1, 0, wanted - sizeof(BlockHead));
    return head + 1;
  }
  return nullptr;
}

}  // namespace

TlsHeap make_tls_heap(void* memory, std::size_t byte_count) {
  PLATFORM_CHECK(memory != nullptr && reinterpret_cast<std::uintptr_t>(memory) % kGrain == 0);
  PLATFORM_CHECK(byte_count >= 2 * kGrain && byte_count % kGrain == 0);
  TlsHeap heap;
  heap.bytes = static_cast<unsigned char*>(memory);
  heap.byte_count = byte_count;
  *head_at(&heap, 0) = {byte_count, 1};
  return heap;
}

TlsHeapUse::TlsHeapUse(TlsHeap* heap) : before_(heap_in_use) { heap_in_use = heap; }
TlsHeapUse::~TlsHeapUse() { heap_in_use = before_; }

}  // namespace platform

void* pocketray_tls_calloc(std::size_t count, std::size_t byte_count) {
  platform::TlsHeap* heap = platform::heap_in_use;
  PLATFORM_CHECK(heap != nullptr);
  const bool overflows = byte_count > 0 && count > heap->byte_count / byte_count;
  void* block = overflows ? nullptr : platform::take_block(heap, count * byte_count);
  if (!block) heap->refused = true;
  return block;
}

void pocketray_tls_free(void* block) {
  if (!block) return;
  platform::TlsHeap* heap = platform::heap_in_use;
  PLATFORM_CHECK(heap != nullptr);
  auto* at = static_cast<unsigned char*>(block);
  PLATFORM_CHECK(at > heap->bytes && at < heap->bytes + heap->byte_count);  // the heap it came from
  platform::BlockHead* head = static_cast<platform::BlockHead*>(block) - 1;
  PLATFORM_CHECK_EQ(head->is_free, std::size_t(0));
  heap->used -= head->byte_count;
  head->is_free = 1;
  platform::join_free(heap, static_cast<std::size_t>(at - heap->bytes) - sizeof(platform::BlockHead));
}
