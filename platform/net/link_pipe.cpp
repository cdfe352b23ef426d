#include "platform/net/link_pipe.h"

#include <cstring>

#include "platform/check.h"

namespace platform {

std::uint64_t line_arrival_ns(const LinkLine& line, std::size_t byte_count, std::uint64_t now_ns,
                              std::uint64_t* free_ns, std::uint64_t* random) {
  std::uint64_t rate = line.bytes_per_second;
  if (*free_ns < now_ns) *free_ns = now_ns;
  if (rate > 0) *free_ns += (byte_count * kSecondNs + rate - 1) / rate;
  return *free_ns + line.latency_ns + (line.jitter_ns > 0 ? random_u64(random) % (line.jitter_ns + 1) : 0);
}

// SplitMix64 [Steele, Lea, Flood 2014, fig. 17].
std::uint64_t random_u64(std::uint64_t* state) {
  std::uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

std::size_t pipe_need(std::size_t capacity) { return kPiecesMax * sizeof(LinkPiece) + (capacity + 15) / 16 * 16; }

void place_pipe(LinkPipe* pipe, std::size_t capacity, unsigned char** memory) {
  PLATFORM_CHECK_GT(capacity, 0u);
  PLATFORM_CHECK_EQ(reinterpret_cast<std::uintptr_t>(*memory) % alignof(LinkPiece), 0u);
  pipe->pieces = reinterpret_cast<LinkPiece*>(*memory);
  pipe->bytes = *memory + kPiecesMax * sizeof(LinkPiece);
  pipe->capacity = capacity;
  *memory += pipe_need(capacity);
}

void reset_pipe(LinkPipe* pipe) {
  LinkPipe empty = {};
  empty.bytes = pipe->bytes;
  empty.capacity = pipe->capacity;
  empty.pieces = pipe->pieces;
  empty.end_ns = empty.reset_ns = kNever;
  *pipe = empty;
}

std::size_t pipe_room(const LinkPipe& pipe) {
  if (pipe.piece_count == kPiecesMax) return 0;
  std::size_t room = pipe.capacity - pipe.used;
  return room < kPieceBytesMax ? room : kPieceBytesMax;
}

void push_piece(LinkPipe* pipe, const unsigned char* bytes, std::size_t byte_count, unsigned char flip,
                std::uint64_t arrival_ns) {
  PLATFORM_CHECK(byte_count > 0 && byte_count <= pipe_room(*pipe));
  for (std::size_t i = 0; i < byte_count; ++i)
    pipe->bytes[(pipe->first + pipe->used + i) % pipe->capacity] =
        static_cast<unsigned char>(i == 0 ? bytes[i] ^ flip : bytes[i]);
  pipe->used += byte_count;
  if (arrival_ns < pipe->arrival_last_ns) arrival_ns = pipe->arrival_last_ns;
  pipe->arrival_last_ns = arrival_ns;
  pipe->pieces[(pipe->piece_first + pipe->piece_count++) % kPiecesMax] = {arrival_ns, byte_count};
}

std::size_t due_bytes(const LinkPipe& pipe, std::uint64_t now_ns, const unsigned char** bytes) {
  *bytes = pipe.bytes + pipe.first;
  if (pipe.piece_count == 0 || pipe.pieces[pipe.piece_first].arrival_ns > now_ns) return 0;
  std::size_t count = pipe.pieces[pipe.piece_first].byte_count, to_end = pipe.capacity - pipe.first;
  return count < to_end ? count : to_end;
}

void drop_bytes(LinkPipe* pipe, std::size_t byte_count) {
  LinkPiece* piece = &pipe->pieces[pipe->piece_first];
  PLATFORM_CHECK_GT(pipe->piece_count, 0);
  PLATFORM_CHECK_LE(byte_count, piece->byte_count);
  pipe->first = (pipe->first + byte_count) % pipe->capacity;
  pipe->used -= byte_count;
  piece->byte_count -= byte_count;
  if (piece->byte_count > 0) return;
  pipe->piece_first = (pipe->piece_first + 1) % kPiecesMax;
  --pipe->piece_count;
}

std::size_t pull_bytes(LinkPipe* pipe, unsigned char* bytes, std::size_t byte_count_max, std::uint64_t now_ns) {
  std::size_t count = 0;
  const unsigned char* from;
  while (count < byte_count_max) {
    std::size_t take = due_bytes(*pipe, now_ns, &from);
    if (take == 0) break;
    if (take > byte_count_max - count) take = byte_count_max - count;
    std::memcpy(bytes + count, from, take);
    drop_bytes(pipe, take);
    count += take;
  }
  return count;
}

std::uint64_t pipe_news_ns(const LinkPipe& pipe) {
  std::uint64_t news = pipe.end_ns < pipe.reset_ns ? pipe.end_ns : pipe.reset_ns;
  if (pipe.piece_count == 0) return news;
  std::uint64_t arrival = pipe.pieces[pipe.piece_first].arrival_ns;
  return arrival < news ? arrival : news;
}

}  // namespace platform
