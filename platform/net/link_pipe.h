// One direction of a simulated connection: a line on which bytes take time, and a pipe of pieces in transit with their
// arrival times.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

constexpr std::uint64_t kNever = ~std::uint64_t{0};
constexpr int kPiecesMax = 256;
constexpr std::size_t kPieceBytesMax = 1460;  // payload of an Ethernet frame

constexpr std::uint64_t kSecondNs = 1'000'000'000;

struct LinkLine {
  std::uint64_t bytes_per_second = 0;  // 0: no limit
  std::uint64_t latency_ns = 0;        // one way
  std::uint64_t jitter_ns = 0;         // maximum addition to the latency
  std::uint32_t lost_per_million = 0;  // pieces lost and repeated
};

// Returns when bytes sent now arrive, on a line that is busy until *free_ns, which is advanced. `random` is the state
// of random_u64().
std::uint64_t line_arrival_ns(const LinkLine& line, std::size_t byte_count, std::uint64_t now_ns,
                              std::uint64_t* free_ns, std::uint64_t* random);
std::uint64_t random_u64(std::uint64_t* state);

struct LinkPiece {
  std::uint64_t arrival_ns;  // at the reader: after every piece before it
  std::size_t byte_count;
  std::uint64_t own_ns;  // at the other end of the line
  bool lost;             // repeated; own_ns is then that of the repeated piece
};

struct LinkPipe {
  unsigned char* bytes;  // ring of `capacity` bytes
  std::size_t capacity, first, used;
  LinkPiece* pieces;  // ring of kPiecesMax
  int piece_first, piece_count;
  std::uint64_t byte_index;        // of the next byte to be sent
  std::uint64_t arrival_last_ns;   // nothing overtakes
  std::uint64_t free_ns;           // until when its own line is busy, if it has one
  std::uint64_t end_ns, reset_ns;  // when the reader learns of them; kNever: never
  std::uint32_t faults_struck;     // one bit per fault
  bool silent, trickles;
};

// pipe_need(): bytes of memory for a pipe of that capacity. make_pipe(): a pipe in that memory, aligned to 8, which
// still must be reset; *memory is advanced.
std::size_t pipe_need(std::size_t capacity);
void place_pipe(LinkPipe* pipe, std::size_t capacity, unsigned char** memory);
// Empties a pipe, keeping its memory.
void reset_pipe(LinkPipe* pipe);
// Most bytes for one more piece; 0: no room.
std::size_t pipe_room(const LinkPipe& pipe);
// Sends one piece of at most pipe_room() bytes; `flip` is XORed into its first byte.
void push_piece(LinkPipe* pipe, const unsigned char* bytes, std::size_t byte_count, unsigned char flip,
                std::uint64_t arrival_ns);
// Decides whether the last pushed piece is lost: call after each push_piece(). As with TCP, a lost piece is repeated
// and later ones wait: a round trip after the third later piece [RFC 5681, sec. 3.2], otherwise two round trips and 10
// ms after the last piece sent [RFC 8985, sec. 7.2] or, if it is the only one in transit, 200 ms more [Linux:
// tcp_rto_min]. A piece repeated after a time-out may be lost again.
void lose_piece(const LinkLine& line, LinkPipe* pipe, std::uint64_t* random);
// Returns the contiguous bytes that have arrived by now, at most one piece, and their address.
std::size_t due_bytes(const LinkPipe& pipe, std::uint64_t now_ns, const unsigned char** bytes);
// Removes at most that many of them.
void drop_bytes(LinkPipe* pipe, std::size_t byte_count);
// Reads the bytes that have arrived by now; returns their number.
std::size_t pull_bytes(LinkPipe* pipe, unsigned char* bytes, std::size_t byte_count_max, std::uint64_t now_ns);
// When the reader next learns something: bytes, the end or a reset. kNever: nothing is scheduled.
std::uint64_t pipe_news_ns(const LinkPipe& pipe);

}  // namespace platform
