#include "base/printable.h"

#include <cstdint>
#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

// Decodes the character at the front of the bytes [RFC 3629, sec. 4]; returns its length, 0 if the bytes are not UTF-8.
std::size_t decode(const unsigned char* at, std::size_t count, std::uint32_t* character) {
  static constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  std::size_t length = at[0] < 0x80 ? 1 : at[0] >> 5 == 6 ? 2 : at[0] >> 4 == 14 ? 3 : at[0] >> 3 == 30 ? 4 : 0;
  if (length == 0 || length > count) return 0;
  *character = length == 1 ? at[0] : at[0] & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (at[i] >> 6 != 2) return 0;
    *character = *character << 6 | (at[i] & 0x3fu);
  }
  bool valid = *character >= kLeast[length] && *character <= 0x10ffff && (*character < 0xd800 || *character > 0xdfff);
  return valid ? length : 0;
}

bool is_harmless(std::uint32_t c) {
  struct Range {
    std::uint32_t first, last;
  };
  static constexpr Range kHarmful[] = {{0, 0x1f},        {0x7f, 0x9f},      {0x61c, 0x61c},   {0x180e, 0x180e},
                                       {0x200b, 0x200f}, {0x2028, 0x202e},  {0x2060, 0x206f}, {0xfeff, 0xfeff},
                                       {0xfff9, 0xfffb}, {0xe0000, 0xe0fff}};
  for (const Range& range : kHarmful)
    if (c >= range.first && c <= range.last) return false;
  return true;
}

}  // namespace

void make_printable(char* text, std::size_t byte_count) {
  CHECK(text != nullptr || byte_count == 0);
  for (std::size_t i = 0; i < byte_count;) {
    std::uint32_t character = 0;
    std::size_t length = decode(reinterpret_cast<const unsigned char*>(text) + i, byte_count - i, &character);
    if (length == 0 || !is_harmless(character)) std::memset(text + i, '?', length > 0 ? length : 1);
    i += length > 0 ? length : 1;
    CHECK_LE(i, byte_count);
  }
}

}  // namespace pocketray
