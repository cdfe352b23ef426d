// Reads, writes and checks the fields of a message.
#pragma once
#include <cstring>

#include "base/limit_list.h"
#include "wire/message.h"

namespace pocketray {

constexpr std::uint32_t kRunBytes = 2;  // of a RowRun

// Reader and Writer process a message with the same function, fields(io, &message), so that both sides agree. The
// length is checked before either runs, except for optional fields.
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
  // The length determines the number of runs.
  void length_of(std::uint8_t* run_count) {
    const std::size_t left = static_cast<std::size_t>(end - at);
    require(left % kRunBytes == 0 && left / kRunBytes <= kRunCountMax);
    *run_count = valid ? static_cast<std::uint8_t>(left / kRunBytes) : 0;
  }
};

// A writer is invalid at the end if it was given values that no reader accepts.
struct Writer {
  std::uint8_t* at;
  bool valid = true;

  void integer(std::uint64_t* value, std::uint32_t byte_count) {
    for (std::uint32_t i = 0; i < byte_count; ++i) at[i] = static_cast<std::uint8_t>(*value >> 8 * i);
    at += byte_count;
  }
  bool has(std::uint32_t) const { return true; }
  void require(bool condition) { valid = valid && condition; }
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

// Visits the fields of an outgoing message; writes nothing.
struct Checker {
  bool valid = true;

  void integer(std::uint64_t*, std::uint32_t) {}
  bool has(std::uint32_t) const { return true; }
  void require(bool condition) { valid = valid && condition; }
  void text(char* text) { require(strnlen(text, kNameBytes) < kNameBytes); }
  void tail(Array<const std::uint8_t>*) {}
  void length_of(std::uint8_t* run_count) { require(*run_count <= kRunCountMax); }
};

// Integers, bools and enumerations of `byte_count` bytes.
template <class Io, class T>
void number(Io& io, T* value, std::uint32_t byte_count = sizeof(T)) {
  std::uint64_t bits = static_cast<std::uint64_t>(*value);
  io.integer(&bits, byte_count);
  *value = static_cast<T>(bits);
}
template <class Io, class T>
void choice(Io& io, T* value, T last) {
  std::uint64_t bits = static_cast<std::uint64_t>(*value);
  io.integer(&bits, sizeof(T));
  io.require(bits <= static_cast<std::uint64_t>(last));
  *value = static_cast<T>(bits);
}
// A number rounded down to 11 significant bits, stored below a 5-bit shift.
template <class Io>
void rounded(Io& io, std::uint32_t* value) {
  constexpr std::uint32_t kBits = 11, kShiftMax = 32 - kBits;
  const std::uint32_t length = *value > 0 ? 32 - static_cast<std::uint32_t>(__builtin_clz(*value)) : 0;
  std::uint32_t shift = length > kBits ? length - kBits : 0;
  std::uint64_t bits = *value >> shift | shift << kBits;
  io.integer(&bits, 2);
  const std::uint32_t kept = static_cast<std::uint32_t>(bits) & ((1u << kBits) - 1);
  shift = static_cast<std::uint32_t>(bits >> kBits);
  io.require(shift <= kShiftMax && (shift == 0 || kept >> (kBits - 1) != 0));
  *value = shift <= kShiftMax ? kept << shift : 0;
}
template <class Io>
void raw_real(Io& io, float* value) {
  std::uint32_t bits;
  std::memcpy(&bits, value, sizeof bits);
  number(io, &bits);
  std::memcpy(value, &bits, sizeof bits);
}
template <class Io>
void raw_real(Io& io, double* value) {
  std::uint64_t bits;
  std::memcpy(&bits, value, sizeof bits);
  number(io, &bits);
  std::memcpy(value, &bits, sizeof bits);
}
// A number within the limits of its quantity.
template <class Io, class T>
void real(Io& io, T* value, Quantity quantity) {
  raw_real(io, value);
  io.require(within(quantity, *value));
}
template <class Io, class T>
void count(Io& io, T* value, Quantity quantity, std::uint32_t byte_count = sizeof(T)) {
  number(io, value, byte_count);
  io.require(within(quantity, static_cast<double>(*value)));
}
}  // namespace pocketray
