#include "scene/content_hash.h"

#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kFirst = 0x87c37b91114253d5ull, kSecond = 0x4cf5ad432745937full;

std::uint64_t rotate(std::uint64_t x, int bits) { return (x << bits) | (x >> (64 - bits)); }

std::uint64_t mix_first(std::uint64_t k) { return rotate(k * kFirst, 31) * kSecond; }
std::uint64_t mix_second(std::uint64_t k) { return rotate(k * kSecond, 33) * kFirst; }

std::uint64_t finish(std::uint64_t h) {
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdull;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ull;
  return h ^ (h >> 33);
}

// Little-endian, up to 8 bytes.
std::uint64_t load(const std::uint8_t* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

}  // namespace

void hash_part(ContentHasher* hasher, const void* data, std::size_t byte_count) {
  CHECK(data != nullptr || byte_count == 0);
  CHECK_EQ(hasher->byte_count % 16, 0u);  // only the last part may have an odd length
  const std::uint8_t* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t a = hasher->a, b = hasher->b;
  std::size_t left = byte_count;
  for (; left >= 16; left -= 16, bytes += 16) {
    a ^= mix_first(load(bytes, 8));
    a = (rotate(a, 27) + b) * 5 + 0x52dce729;
    b ^= mix_second(load(bytes + 8, 8));
    b = (rotate(b, 31) + a) * 5 + 0x38495ab5;
  }
  if (left > 8) b ^= mix_second(load(bytes + 8, left - 8));
  if (left > 0) a ^= mix_first(load(bytes, left < 8 ? left : 8));
  *hasher = {a, b, hasher->byte_count + byte_count};
}

ContentHash hash_end(const ContentHasher& hasher) {
  std::uint64_t a = hasher.a ^ hasher.byte_count, b = hasher.b ^ hasher.byte_count;
  a += b, b += a;
  a = finish(a), b = finish(b);
  a += b, b += a;
  return {a, b};
}

ContentHash content_hash(const void* bytes, std::size_t byte_count) {
  ContentHasher hasher;
  hash_part(&hasher, bytes, byte_count);
  return hash_end(hasher);
}

}  // namespace pocketray
