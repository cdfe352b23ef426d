// State common to both ends of the codec; see codec.h.
#pragma once
#include "wire/codec.h"

namespace pocketray {

constexpr int kWindowBits = -15;  // 32 KiB; negative: no zlib header or checksum, since the message has them
constexpr int kMemoryLevel = 8;

// Upper bound of the body of a chunk, before deflation.
std::uint32_t body_bytes_max(const CodecShape& shape, std::uint32_t row_count);

std::size_t codec_state_need(const CodecShape& shape, std::size_t zlib_bytes);
// `state` must not move afterwards. The caller initialises the stream.
void make_codec_state(const CodecShape& shape, std::size_t zlib_bytes, Arena* arena, CodecState* state);
void restart_codec_state(CodecState* state);

}  // namespace pocketray
