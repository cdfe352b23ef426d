// Operations that both ends of the codec share; see codec.h.
#pragma once
#include "wire/codec.h"

namespace pocketray {

std::size_t codec_state_need(const CodecShape& shape);
void make_codec_state(const CodecShape& shape, Arena* arena, CodecState* state);
void restart_codec_state(CodecState* state);

// Bytes of raw rows.
std::uint32_t raw_bytes(const CodecShape& shape, std::uint32_t row_count);

// Call before writing rows of a frame: from then on picture_row() is their new version, row_before() the old one.
void begin_rows(CodecState* state, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count);

// Writes raw rows.
void put_raw_rows(CodecState* state, std::uint32_t row_begin, std::uint32_t row_count, const std::uint8_t* pixels);

inline const std::uint8_t* version_row(const CodecState& s, std::uint32_t version, std::uint32_t row) {
  return s.versions.data + (std::size_t(version) * s.shape.height + row) * s.shape.width * pixel_bytes(s.shape.format);
}
// The row's version before the current frame.
inline const std::uint8_t* row_before(const CodecState& s, std::uint32_t row) {
  return version_row(s, s.row_frames[row] == s.frame ? s.current[row] ^ 1u : s.current[row], row);
}
// The row below as last sent; black below the picture.
inline const std::uint8_t* row_below(const CodecState& s, std::uint32_t row) {
  return row + 1 < s.shape.height ? picture_row(s, row + 1) : version_row(s, 2, 0);
}

}  // namespace pocketray
