// Adaptive binary range coding [Martin 1979], with carries resolved as they occur [Schindler 1998]: both ends adapt the
// probability of each kind of bit identically, and a bit costs as little as 1/40 bit. Integers only.
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

// Probability that a bit is 0, in 4096ths; 15 to 4081.
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

// Writes at most `capacity` bytes; beyond them it only records the overflow.
class RangeEncoder {
 public:
  static constexpr bool kEncodes = true;

  RangeEncoder(std::uint8_t* bytes, std::size_t capacity) : begin_(bytes), at_(bytes), end_(bytes + capacity) {}

  // Both return the coded value, as the decoder does.
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
  // Codes the low `count` bits of a value with even probability; high bits first.
  std::uint32_t even_bits(std::uint32_t value, std::uint32_t count) {
    while (count-- > 0) {
      range_ >>= 1;
      if (value >> count & 1) low_ += range_;
      normalise();
    }
    return value;
  }

  bool overflows() const { return overflows_; }
  // Ends the code and returns its length. The decoder reads zeros past the end, so trailing zeros are not written.
  std::size_t finish() {
    // Picks the value within the range that has the most trailing zeros.
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
      overflows_ = overflows_ || (byte & 255) != 0;  // trailing zeros are omitted anyway
    else
      *at_++ = static_cast<std::uint8_t>(byte);
  }
  // Shifts out the top byte of `low` once no carry can change it.
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
  std::uint32_t held_ = 0, ones_ = 0;  // byte that a carry may still change, and the number of 0xFF bytes behind it
  bool is_first_ = true, overflows_ = false;
};

// Accepts arbitrary bytes; any input decodes to something.
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
  // Returns whether all bytes were read, as for every valid code.
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
