// Both ends of a codec in their own memory.
#pragma once
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "wire/codec.h"

namespace pocketray {

struct CodecEnds {
  std::vector<std::uint8_t> block, chunk_bytes;
  CodecShape shape;
  Arena arena;
  RowEncoder* encoder = nullptr;
  RowDecoder* decoder = nullptr;

  explicit CodecEnds(const CodecShape& shape_)
      : block(row_encoder_need(shape_) + row_decoder_need(shape_) + kArenaAlignment),
        chunk_bytes(encoded_bytes_max(shape_, shape_.chunk_rows_max)),
        shape(shape_) {
    arena = make_arena("codec", block.data(), block.size());
    REQUIRE(make_row_encoder(shape, &arena, &encoder).ok);
    REQUIRE(make_row_decoder(shape, &arena, &decoder).ok);
  }
  CodecEnds(const CodecEnds&) = delete;

  std::size_t row_bytes() const { return std::size_t(shape.width) * pixel_bytes(shape.format); }

  RowChunk encode(const std::uint8_t* picture, std::uint32_t row_begin, std::uint32_t row_count, int level) {
    RowChunk chunk;
    chunk.row_begin = static_cast<std::uint16_t>(row_begin), chunk.row_count = static_cast<std::uint16_t>(row_count);
    std::uint32_t byte_count = encode_rows(encoder, row_begin, row_count, picture + row_begin * row_bytes(), level,
                                           chunk_bytes.data(), &chunk.encoding);
    REQUIRE(byte_count <= chunk_bytes.size());
    chunk.bytes = {chunk_bytes.data(), byte_count};
    return chunk;
  }

  // Sends a whole picture in chunks from the bottom upward; returns the bytes sent.
  std::size_t send(const std::vector<std::uint8_t>& picture, int level) {
    std::size_t bytes = 0;
    for (std::uint32_t end = shape.height; end > 0;) {
      std::uint32_t begin = end > shape.chunk_rows_max ? end - shape.chunk_rows_max : 0;
      RowChunk chunk = encode(picture.data(), begin, end - begin, level);
      bytes += chunk.bytes.count;
      REQUIRE(decode_rows(decoder, chunk));
      end = begin;
    }
    return bytes;
  }

  bool holds(const std::vector<std::uint8_t>& picture) const {
    return picture.size() == decoder->state.picture.count &&
           std::memcmp(picture.data(), decoder->state.picture.data, picture.size()) == 0;
  }
};

}  // namespace pocketray
