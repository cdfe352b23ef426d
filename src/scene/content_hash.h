// Identity of a scene's bytes, wherever they lie: 128 bits, MurmurHash3_x64_128 [Appleby 2011], seed 0. Two scenes do
// not collide by accident. A hostile peer could make them collide but gains nothing: its scene is checked like any
// file, and its pixels were its own choice anyway.
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

struct ContentHash {
  std::uint64_t low = 0, high = 0;
};
inline bool operator==(const ContentHash& a, const ContentHash& b) { return a.low == b.low && a.high == b.high; }
inline bool operator!=(const ContentHash& a, const ContentHash& b) { return !(a == b); }

ContentHash content_hash(const void* bytes, std::size_t byte_count);

// Hashes bytes that arrive in parts; the size of every part but the last must be a multiple of 16.
struct ContentHasher {
  std::uint64_t a = 0, b = 0, byte_count = 0;
};
void hash_part(ContentHasher* hasher, const void* bytes, std::size_t byte_count);
ContentHash hash_end(const ContentHasher& hasher);

}  // namespace pocketray
