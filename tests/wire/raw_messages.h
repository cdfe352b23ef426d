// Messages as bytes, valid or not.
#pragma once
#include <vector>

#include "wire/message.h"

namespace pocketray {

inline Decoded decode(const std::vector<std::uint8_t>& bytes, Message* message,
                      std::uint32_t message_bytes_max = kMessageBytesMax) {
  return decode_message(bytes.data(), bytes.size(), message_bytes_max, message);
}

inline bool refused(const std::vector<std::uint8_t>& bytes) {
  Message message;
  return decode(bytes, &message).state == DecodeState::malformed;
}

inline std::uint32_t crc_of(const std::vector<std::uint8_t>& message) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (std::size_t i = 0; i < message.size(); ++i) {
    if (i >= 4 && i < 8) continue;
    crc ^= message[i];
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
  }
  return ~crc;
}

// Sets the correct length and checksum of a message, whatever its fields hold.
inline std::vector<std::uint8_t> sealed(std::vector<std::uint8_t> message) {
  std::uint32_t payload = static_cast<std::uint32_t>(message.size() - kHeaderBytes);
  for (std::uint32_t i = 0; i < 3; ++i) message[1 + i] = static_cast<std::uint8_t>(payload >> 8 * i);
  std::uint32_t crc = crc_of(message);
  for (std::uint32_t i = 0; i < 4; ++i) message[4 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  return message;
}

}  // namespace pocketray
