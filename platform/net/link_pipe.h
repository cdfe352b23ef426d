// One direction of a simulated connection: a line that bytes take their time on, and a pipe of bytes underway with when
// each piece of them arrives.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

constexpr std::uint64_t kNever = ~std::uint64_t{0};
constexpr int kPiecesMax = 256;
constexpr std::size_t kPieceBytesMax = 1460;  // as an Ethernet frame holds

constexpr std::uint64_t kSecondNs = 1'000'000'000;

struct LinkLine {
  std::uint64_t bytes_per_second = 0;  // 0: no limit
  std::uint64_t latency_ns = 0;        // one way
  std::uint64_t jitter_ns = 0;         // up to so much more
};

// When so many bytes arrive that are sent now, on a line that has sent what it has by *free_ns; moves that on. `random`
// is the state of random_u64().
std::uint64_t line_arrival_ns(const LinkLine& line, std::size_t byte_count, std::uint64_t now_ns,
                              std::uint64_t* free_ns, std::uint64_t* random);
std::uint64_t random_u64(std::uint64_t* state);

struct LinkPiece {
  std::uint64_t arrival_ns;
  std::size_t byte_count;
};

struct LinkPipe {
  unsigned char* bytes;  // a ring of `capacity`
  std::size_t capacity, first, used;
  LinkPiece* pieces;  // a ring of kPiecesMax
  int piece_first, piece_count;
  std::uint64_t byte_index;        // of the next byte to be sent
  std::uint64_t arrival_last_ns;   // nothing overtakes
  std::uint64_t trickle_free_ns;   // when the next byte may go while it trickles
  std::uint64_t end_ns, reset_ns;  // when their news arrive; kNever: they do not
  std::uint32_t faults_struck;     // a bit for each
  bool silent, trickles;
};

// Bytes of memory that a pipe of that capacity takes, and such a pipe, not yet reset, in memory that is aligned to 8;
// *memory moves on.
std::size_t pipe_need(std::size_t capacity);
void place_pipe(LinkPipe* pipe, std::size_t capacity, unsigned char** memory);
// An empty pipe over memory that is there already.
void reset_pipe(LinkPipe* pipe);
// Room for one more piece: its bytes; 0: none.
std::size_t pipe_room(const LinkPipe& pipe);
// One piece of at most pipe_room() bytes, its first changed by `flip`.
void push_piece(LinkPipe* pipe, const unsigned char* bytes, std::size_t byte_count, unsigned char flip,
                std::uint64_t arrival_ns);
// Bytes that have arrived by now and lie together, at most those of one piece, and where.
std::size_t due_bytes(const LinkPipe& pipe, std::uint64_t now_ns, const unsigned char** bytes);
// Takes as many of them as that, at most.
void drop_bytes(LinkPipe* pipe, std::size_t byte_count);
// Takes what has arrived by now; returns how many bytes.
std::size_t pull_bytes(LinkPipe* pipe, unsigned char* bytes, std::size_t byte_count_max, std::uint64_t now_ns);
// When the reader learns something next: bytes, the end or a reset. kNever: not by itself.
std::uint64_t pipe_news_ns(const LinkPipe& pipe);

}  // namespace platform
