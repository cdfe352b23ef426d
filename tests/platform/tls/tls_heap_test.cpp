// The heap of a stream's TLS library.
#include "platform/net/tls/tls_heap.h"

#include <doctest/doctest.h>

#include <cstring>
#include <map>
#include <vector>

#include "platform/net/link_pipe.h"
#include "platform/tls/tls_rig.h"
#include "support/effort.h"

using namespace platform;

// Goal: blocks are zeroed, aligned, apart from each other and within the heap; what is freed can be taken again, up to
// the last byte. Method: random requests against a model that fills every block with its own byte.
TEST_CASE("tls_heap_keeps_blocks_apart") {
  std::vector<HeapGrain> memory(4096 / sizeof(HeapGrain));
  TlsHeap heap = make_tls_heap(memory.data(), 4096);
  TlsHeapUse use(&heap);
  std::map<unsigned char*, std::size_t> blocks;
  std::uint64_t state = 7;
  int refused = 0;
  for (int i = 0; i < pocketray::effort(100'000); ++i) {
    std::uint64_t random = random_u64(&state);
    if (random % 5 < 3) {
      std::size_t count = 1 + (random >> 8) % 3, each = (random >> 16) % 200;
      auto* block = static_cast<unsigned char*>(pocketray_tls_calloc(count, each));
      if (!block) {
        ++refused;
        continue;
      }
      REQUIRE_EQ(reinterpret_cast<std::uintptr_t>(block) % 16, 0u);
      REQUIRE(block >= heap.bytes);
      REQUIRE(block + count * each <= heap.bytes + heap.byte_count);
      for (std::size_t k = 0; k < count * each; ++k) REQUIRE_EQ(block[k], 0);
      std::memset(block, static_cast<int>(random >> 56) | 1, count * each);
      REQUIRE(blocks.emplace(block, count * each).second);
    } else if (!blocks.empty()) {
      auto chosen = blocks.upper_bound(heap.bytes + (random >> 8) % heap.byte_count);
      if (chosen == blocks.end()) chosen = blocks.begin();
      for (std::size_t k = 1; k < chosen->second; ++k) REQUIRE_EQ(chosen->first[k], chosen->first[0]);
      pocketray_tls_free(chosen->first);
      blocks.erase(chosen);
    }
    REQUIRE_LE(heap.used, heap.byte_count);
  }
  CHECK_GT(refused, 0);
  for (const auto& block : blocks) pocketray_tls_free(block.first);
  CHECK_EQ(heap.used, 0u);
  void* all = pocketray_tls_calloc(1, 4096 - 16);
  CHECK(all != nullptr);
  CHECK(pocketray_tls_calloc(1, 1) == nullptr);
  pocketray_tls_free(all);
  pocketray_tls_free(nullptr);
  CHECK_EQ(heap.used_max, 4096u);
}

// Goal: a product that overflows is refused, not truncated. Method: factors whose product is 0 modulo 2⁶⁴, or near it.
TEST_CASE("tls_heap_refuses_products_that_overflow") {
  std::vector<HeapGrain> memory(1024 / sizeof(HeapGrain));
  TlsHeap heap = make_tls_heap(memory.data(), 1024);
  TlsHeapUse use(&heap);
  const std::size_t half = std::size_t(1) << (4 * sizeof(std::size_t));
  CHECK(pocketray_tls_calloc(half, half) == nullptr);
  CHECK(pocketray_tls_calloc(~std::size_t(0), 1) == nullptr);
  CHECK(pocketray_tls_calloc(1, ~std::size_t(0)) == nullptr);
  CHECK(pocketray_tls_calloc(~std::size_t(0), ~std::size_t(0)) == nullptr);
  CHECK_EQ(heap.used, 0u);
}
