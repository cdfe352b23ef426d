// What both ends of the codec do alike; see codec.h.
#pragma once
#include "wire/codec.h"

namespace pocketray {

std::size_t codec_state_need(const CodecShape& shape);
void make_codec_state(const CodecShape& shape, Arena* arena, CodecState* state);
void restart_codec_state(CodecState* state);

// Bytes of rows as pixels.
std::uint32_t raw_bytes(const CodecShape& shape, std::uint32_t row_count);

// Before rows of a frame are written: from now on picture_row() is their new version, row_before() the old one.
void begin_rows(CodecState* state, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count);

// Writes rows that are not coded.
void put_raw_rows(CodecState* state, std::uint32_t row_begin, std::uint32_t row_count, const std::uint8_t* pixels);

inline const std::uint8_t* version_row(const CodecState& s, std::uint32_t version, std::uint32_t row) {
  return s.versions.data + (std::size_t(version) * s.shape.height + row) * s.shape.width * pixel_bytes(s.shape.format);
}
// A row as it was before the current frame.
inline const std::uint8_t* row_before(const CodecState& s, std::uint32_t row) {
  return version_row(s, s.row_frames[row] == s.frame ? s.current[row] ^ 1u : s.current[row], row);
}
// The row below, as it was sent last; black below the picture.
inline const std::uint8_t* row_below(const CodecState& s, std::uint32_t row) {
  return row + 1 < s.shape.height ? picture_row(s, row + 1) : version_row(s, 2, 0);
}

}  // namespace pocketray
