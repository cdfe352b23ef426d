// Adaptive binary range coding [Martin 1979], with carries resolved as they occur [Schindler 1998]: both ends adapt the
// probability of each kind of bit alike, so that a bit takes as little as a 40th of a bit. Integers only.
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

// That a bit is 0, in 4096ths; 15 to 4081.
using Probability = std::uint16_t;
constexpr std::uint32_t kProbabilityBits = 12;
constexpr Probability kEven = 1u << (kProbabilityBits - 1);
constexpr int kAdaptShift = 4;  // measured by codec_frames_test: 5 adapts too slowly for chunks of a few rows
constexpr std::uint32_t kRangeMin = 1u << 24;

inline void adapt(Probability* probability, std::uint32_t bit) {
  const std::uint32_t p = *probability;
  *probability =
      static_cast<Probability>(bit ? p - (p >> kAdaptShift) : p + (((1u << kProbabilityBits) - p) >> kAdaptShift));
}

// Writes at most `capacity` bytes; beyond them, it only notes that they do not suffice.
class RangeEncoder {
 public:
  static constexpr bool kEncodes = true;

  RangeEncoder(std::uint8_t* bytes, std::size_t capacity) : begin_(bytes), at_(bytes), end_(bytes + capacity) {}

  // Both return what they code, as the decoder does.
  std::uint32_t bit(Probability* probability, std::uint32_t value) {
    const std::uint32_t bound = (range_ >> kProbabilityBits) * *probability;
    if (value) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    adapt(probability, value);
    normalise();
    return value;
  }
  // The low `count` bits of a value, each as likely 0 as 1; high bits first.
  std::uint32_t even_bits(std::uint32_t value, std::uint32_t count) {
    while (count-- > 0) {
      range_ >>= 1;
      if (value >> count & 1) low_ += range_;
      normalise();
    }
    return value;
  }

  bool overflows() const { return overflows_; }
  // Ends the code; returns its length. The decoder reads zeros past the end, so none are written there.
  std::size_t finish() {
    // Of the values within the range, the one with the most zeros at its end.
    const std::uint64_t high = low_ + range_ - 1;
    std::uint64_t value = low_;
    for (int zeros = 31; zeros >= 0; --zeros) {
      value = high >> zeros << zeros;
      if (value >= low_) break;
    }
    low_ = value;
    for (int i = 0; i < 5; ++i) shift_low();
    while (at_ > begin_ && at_[-1] == 0) --at_;
    return static_cast<std::size_t>(at_ - begin_);
  }

 private:
  void normalise() {
    while (range_ < kRangeMin) {
      range_ <<= 8;
      shift_low();
    }
  }
  void put(std::uint32_t byte) {
    if (at_ == end_)
      overflows_ = overflows_ || (byte & 255) != 0;  // zeros at the end are left out anyway
    else
      *at_++ = static_cast<std::uint8_t>(byte);
  }
  // Moves the top byte of `low` out, once no carry can change it any more.
  void shift_low() {
    const std::uint32_t carry = static_cast<std::uint32_t>(low_ >> 32), low = static_cast<std::uint32_t>(low_);
    if (low < 0xFF000000u || carry != 0) {
      if (!is_first_) put(held_ + carry);  // the first byte is always 0
      is_first_ = false;
      for (; ones_ > 0; --ones_) put(0xFF + carry);
      held_ = low >> 24;
    } else {
      ++ones_;
    }
    low_ = std::uint64_t(low & 0x00FFFFFFu) << 8;
  }

  std::uint8_t *begin_, *at_, *end_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = ~0u;
  std::uint32_t held_ = 0, ones_ = 0;  // the byte that a carry may change, and bytes 0xFF behind it
  bool is_first_ = true, overflows_ = false;
};

// Decodes any bytes to something.
class RangeDecoder {
 public:
  static constexpr bool kEncodes = false;

  RangeDecoder(const std::uint8_t* bytes, std::size_t byte_count) : at_(bytes), end_(bytes + byte_count) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next_byte();
  }
  std::uint32_t bit(Probability* probability, std::uint32_t /*value*/) {
    const std::uint32_t bound = (range_ >> kProbabilityBits) * *probability;
    const std::uint32_t value = code_ < bound ? 0 : 1;
    if (value) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    adapt(probability, value);
    normalise();
    return value;
  }
  std::uint32_t even_bits(std::uint32_t /*value*/, std::uint32_t count) {
    std::uint32_t value = 0;
    while (count-- > 0) {
      range_ >>= 1;
      const std::uint32_t one = code_ < range_ ? 0 : 1;
      if (one) code_ -= range_;
      value = value << 1 | one;
      normalise();
    }
    return value;
  }
  // Whether all bytes were read, as they are of every code.
  bool is_at_end() const { return at_ == end_; }

 private:
  std::uint32_t next_byte() { return at_ < end_ ? *at_++ : 0u; }
  void normalise() {
    while (range_ < kRangeMin) {
      range_ <<= 8;
      code_ = code_ << 8 | next_byte();
    }
  }

  const std::uint8_t *at_, *end_;
  std::uint32_t range_ = ~0u, code_ = 0;
};

}  // namespace pocketray
