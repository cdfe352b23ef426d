// What both ends of the codec have in common; see codec.h.
#pragma once
#include "wire/codec.h"

namespace pocketray {

constexpr int kWindowBits = -15;  // 32 KiB; negative: without zlib's header and checksum, which the message has
constexpr int kMemoryLevel = 8;

// The most that the body of a chunk takes, before deflation.
std::uint32_t body_bytes_max(const CodecShape& shape, std::uint32_t row_count);

std::size_t codec_state_need(const CodecShape& shape, std::size_t zlib_bytes);
// `state` has to stay where it is. Leaves the stream to be initialised.
void make_codec_state(const CodecShape& shape, std::size_t zlib_bytes, Arena* arena, CodecState* state);
void restart_codec_state(CodecState* state);

}  // namespace pocketray
