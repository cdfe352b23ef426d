#include "platform/net/link_pipe.h"

#include <cstring>

#include "platform/check.h"

namespace platform {
namespace {

constexpr std::uint64_t kProbeNs = 10'000'000, kAloneNs = 200'000'000;
constexpr int kRepeatsMax = 8;

LinkPiece* piece_at(LinkPipe* pipe, int i) { return &pipe->pieces[(pipe->piece_first + i) % kPiecesMax]; }

bool is_struck(const LinkLine& line, std::uint64_t* random) {
  return random_u64(random) % 1'000'000 < line.lost_per_million;
}

}  // namespace

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
  std::uint64_t own_ns = arrival_ns;
  if (arrival_ns < pipe->arrival_last_ns) arrival_ns = pipe->arrival_last_ns;
  pipe->arrival_last_ns = arrival_ns;
  *piece_at(pipe, pipe->piece_count++) = {arrival_ns, byte_count, own_ns, false};
}

void lose_piece(const LinkLine& line, LinkPipe* pipe, std::uint64_t* random) {
  if (line.lost_per_million == 0) return;
  PLATFORM_CHECK_GT(pipe->piece_count, 0);
  const int last = pipe->piece_count - 1;
  const std::uint64_t round_trip_ns = 2 * line.latency_ns;
  LinkPiece* piece = piece_at(pipe, last);
  int first_changed = last;
  if (is_struck(line, random)) {
    std::uint64_t wait_ns = 2 * round_trip_ns + kProbeNs + (last == 0 ? kAloneNs : 0);
    piece->lost = true;
    piece->own_ns += wait_ns;
    for (int i = 0; i < kRepeatsMax && is_struck(line, random); ++i) piece->own_ns += wait_ns *= 2;
  } else {
    for (int i = last - 1, later = 1; i >= 0 && later <= 3; --i) {
      LinkPiece* before = piece_at(pipe, i);
      if (!before->lost) {
        ++later;
        continue;
      }
      std::uint64_t repeated_ns = piece->own_ns + (later == 3 ? round_trip_ns : 2 * round_trip_ns + kProbeNs);
      if (repeated_ns < before->own_ns) before->own_ns = repeated_ns;
      first_changed = i;
    }
  }
  // Nothing overtakes.
  std::uint64_t arrival_ns = first_changed > 0 ? piece_at(pipe, first_changed - 1)->arrival_ns : 0;
  for (int i = first_changed; i <= last; ++i) {
    LinkPiece* at = piece_at(pipe, i);
    if (arrival_ns < at->own_ns) arrival_ns = at->own_ns;
    at->arrival_ns = arrival_ns;
  }
  pipe->arrival_last_ns = arrival_ns;
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
