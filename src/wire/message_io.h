// Reading, writing and checking the fields of a message.
#pragma once
#include <cstring>

#include "base/check.h"
#include "wire/message.h"

namespace pocketray {

constexpr std::uint32_t kRunBytes = 2;  // of a RowRun

// Reader and Writer process the fields of a message with the same function, fields(io, &message), so that both sides
// agree. The length is checked before either runs, except for fields that may be absent.
struct Reader {
  const std::uint8_t* at;
  const std::uint8_t* end;
  bool valid = true;

  void integer(std::uint64_t* value, std::uint32_t byte_count) {
    *value = 0;
    for (std::uint32_t i = byte_count; i-- > 0;) *value = *value << 8 | at[i];
    at += byte_count;
  }
  bool has(std::uint32_t byte_count) const { return static_cast<std::size_t>(end - at) >= byte_count; }
  void require(bool condition) { valid = valid && condition; }
  void text(char* text) {
    std::memcpy(text, at, kNameBytes);
    at += kNameBytes;
    std::size_t length = strnlen(text, kNameBytes);
    for (std::size_t i = length; i < kNameBytes; ++i) require(text[i] == 0);
    require(length < kNameBytes);
  }
  void tail(Array<const std::uint8_t>* bytes) {
    *bytes = {at, static_cast<std::uint32_t>(end - at)};
    at = end;
  }
  // The number of runs follows from the length.
  void length_of(std::uint8_t* run_count) {
    const std::size_t left = static_cast<std::size_t>(end - at);
    require(left % kRunBytes == 0 && left / kRunBytes <= kRunCountMax);
    *run_count = valid ? static_cast<std::uint8_t>(left / kRunBytes) : 0;
  }
};

struct Writer {
  std::uint8_t* at;

  void integer(std::uint64_t* value, std::uint32_t byte_count) {
    for (std::uint32_t i = 0; i < byte_count; ++i) at[i] = static_cast<std::uint8_t>(*value >> 8 * i);
    at += byte_count;
  }
  bool has(std::uint32_t) const { return true; }
  void require(bool condition) { CHECK(condition); }
  void text(char* text) {
    require(strnlen(text, kNameBytes) < kNameBytes);
    std::memset(at, 0, kNameBytes);
    std::memcpy(at, text, strnlen(text, kNameBytes));
    at += kNameBytes;
  }
  void tail(Array<const std::uint8_t>* bytes) {
    if (bytes->count) std::memmove(at, bytes->data, bytes->count);
    at += bytes->count;
  }
  void length_of(std::uint8_t* run_count) { require(*run_count <= kRunCountMax); }
};

// Visits the fields of a message to be sent and writes nothing.
struct Checker {
  bool valid = true;

  void integer(std::uint64_t*, std::uint32_t) {}
  bool has(std::uint32_t) const { return true; }
  void require(bool condition) { valid = valid && condition; }
  void text(char* text) { require(strnlen(text, kNameBytes) < kNameBytes); }
  void tail(Array<const std::uint8_t>*) {}
  void length_of(std::uint8_t* run_count) { require(*run_count <= kRunCountMax); }
};

}  // namespace pocketray
