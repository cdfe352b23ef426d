// One direction of a simulated connection: bytes underway and when each piece of them arrives.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

constexpr std::uint64_t kNever = ~std::uint64_t{0};
constexpr int kPiecesMax = 256;
constexpr std::size_t kPieceBytesMax = 1460;  // as an Ethernet frame holds

struct NullPiece {
  std::uint64_t arrival_ns;
  std::size_t byte_count;
};

struct NullPipe {
  unsigned char* bytes;  // a ring of `capacity`
  std::size_t capacity, first, used;
  NullPiece* pieces;  // a ring of kPiecesMax
  int piece_first, piece_count;
  std::uint64_t byte_index;        // of the next byte to be sent
  std::uint64_t arrival_last_ns;   // nothing overtakes
  std::uint64_t trickle_free_ns;   // when the next byte may go while it trickles
  std::uint64_t end_ns, reset_ns;  // when their news arrive; kNever: they do not
  std::uint32_t faults_struck;     // a bit for each
  bool silent, trickles;
};

// An empty pipe over memory that is there already.
void reset_pipe(NullPipe* pipe);
// Room for one more piece: its bytes; 0: none.
std::size_t pipe_room(const NullPipe& pipe);
// One piece of at most pipe_room() bytes, its first changed by `flip`.
void push_piece(NullPipe* pipe, const unsigned char* bytes, std::size_t byte_count, unsigned char flip,
                std::uint64_t arrival_ns);
// Takes what has arrived by now; returns how many bytes.
std::size_t pull_bytes(NullPipe* pipe, unsigned char* bytes, std::size_t byte_count_max, std::uint64_t now_ns);
// When the reader learns something next: bytes, the end or a reset. kNever: not by itself.
std::uint64_t pipe_news_ns(const NullPipe& pipe);

}  // namespace platform
