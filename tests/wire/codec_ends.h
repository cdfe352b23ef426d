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
  std::uint32_t frame = 1;

  explicit CodecEnds(const CodecShape& shape_)
      : block(row_encoder_need(shape_) + row_decoder_need(shape_) + kArenaAlignment),
        chunk_bytes(encoded_bytes_max(shape_, shape_.chunk_rows_max)),
        shape(shape_) {
    arena = make_arena("codec", block.data(), block.size());
    make_row_encoder(shape, &arena, &encoder);
    make_row_decoder(shape, &arena, &decoder);
  }
  CodecEnds(const CodecEnds&) = delete;

  std::size_t row_bytes() const { return std::size_t(shape.width) * pixel_bytes(shape.format); }

  RowChunk encode(const std::uint8_t* picture, std::uint32_t row_begin, std::uint32_t row_count, RowCoding coding) {
    RowChunk chunk;
    chunk.frame = frame;
    chunk.row_begin = static_cast<std::uint16_t>(row_begin), chunk.row_count = static_cast<std::uint16_t>(row_count);
    std::uint32_t byte_count = encode_rows(encoder, frame, row_begin, row_count, picture + row_begin * row_bytes(),
                                           coding, chunk_bytes.data(), &chunk.encoding);
    REQUIRE(byte_count <= chunk_bytes.size());
    chunk.bytes = {chunk_bytes.data(), byte_count};
    return chunk;
  }

  // Sends a whole picture, a new frame, in chunks from the bottom upward; returns the bytes sent.
  std::size_t send(const std::vector<std::uint8_t>& picture, RowCoding coding) {
    std::size_t bytes = 0;
    ++frame;
    for (std::uint32_t end = shape.height; end > 0;) {
      std::uint32_t begin = end > shape.chunk_rows_max ? end - shape.chunk_rows_max : 0;
      RowChunk chunk = encode(picture.data(), begin, end - begin, coding);
      bytes += chunk.bytes.count;
      REQUIRE(decode_rows(decoder, chunk));
      end = begin;
    }
    return bytes;
  }

  bool holds(const std::vector<std::uint8_t>& picture) const {
    for (std::uint32_t row = 0; row < shape.height; ++row)
      if (std::memcmp(&picture[row * row_bytes()], picture_row(decoder->state, row), row_bytes()) != 0) return false;
    return picture.size() == shape.height * row_bytes();
  }
};

}  // namespace pocketray
