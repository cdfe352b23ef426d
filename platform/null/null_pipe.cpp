#include "platform/null/null_pipe.h"

namespace platform {

void reset_pipe(NullPipe* pipe) {
  NullPipe empty = {};
  empty.bytes = pipe->bytes;
  empty.capacity = pipe->capacity;
  empty.pieces = pipe->pieces;
  empty.end_ns = empty.reset_ns = kNever;
  *pipe = empty;
}

std::size_t pipe_room(const NullPipe& pipe) {
  if (pipe.piece_count == kPiecesMax) return 0;
  std::size_t room = pipe.capacity - pipe.used;
  return room < kPieceBytesMax ? room : kPieceBytesMax;
}

void push_piece(NullPipe* pipe, const unsigned char* bytes, std::size_t byte_count, unsigned char flip,
                std::uint64_t arrival_ns) {
  for (std::size_t i = 0; i < byte_count; ++i)
    pipe->bytes[(pipe->first + pipe->used + i) % pipe->capacity] =
        static_cast<unsigned char>(i == 0 ? bytes[i] ^ flip : bytes[i]);
  pipe->used += byte_count;
  if (arrival_ns < pipe->arrival_last_ns) arrival_ns = pipe->arrival_last_ns;
  pipe->arrival_last_ns = arrival_ns;
  pipe->pieces[(pipe->piece_first + pipe->piece_count++) % kPiecesMax] = {arrival_ns, byte_count};
}

std::size_t pull_bytes(NullPipe* pipe, unsigned char* bytes, std::size_t byte_count_max, std::uint64_t now_ns) {
  std::size_t count = 0;
  while (count < byte_count_max && pipe->piece_count > 0) {
    NullPiece* piece = &pipe->pieces[pipe->piece_first];
    if (piece->arrival_ns > now_ns) break;
    std::size_t take = piece->byte_count < byte_count_max - count ? piece->byte_count : byte_count_max - count;
    for (std::size_t i = 0; i < take; ++i) bytes[count + i] = pipe->bytes[(pipe->first + i) % pipe->capacity];
    pipe->first = (pipe->first + take) % pipe->capacity;
    pipe->used -= take;
    count += take;
    piece->byte_count -= take;
    if (piece->byte_count == 0) {
      pipe->piece_first = (pipe->piece_first + 1) % kPiecesMax;
      --pipe->piece_count;
    }
  }
  return count;
}

std::uint64_t pipe_news_ns(const NullPipe& pipe) {
  std::uint64_t news = pipe.end_ns < pipe.reset_ns ? pipe.end_ns : pipe.reset_ns;
  if (pipe.piece_count == 0) return news;
  std::uint64_t arrival = pipe.pieces[pipe.piece_first].arrival_ns;
  return arrival < news ? arrival : news;
}

}  // namespace platform
