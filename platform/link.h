// The link contract: byte streams to peers, as one struct of functions per backend. Standard types only; net/tcp.h has
// the real one, null/net/null_link.h one with a virtual clock and faults.
//
// A Link lives in memory the caller gives, is used from one thread and takes no other memory after open(); there may be
// several. No call waits, but poll() up to its timeout and resolve() as long as the system's resolver does. A stream is
// a number ≥ 0 that stands for a connection or a listener until close(); afterwards it is stale, and every call with it
// fails.
#pragma once
#include <cstddef>
#include <cstdint>

#include "platform/platform.h"

namespace platform {

constexpr int kLinkStreamsMax = 256;  // of one Link, listeners included

// Where a peer is, or is to be waited for.
struct LinkAddress {
  static constexpr int kPlacesMax = 4;
  char text[96] = {0};    // as it was asked for, for messages
  bool loopback = false;  // every place is on this machine alone
  int place_count = 0;    // a name may stand for several; connect() tries one after the other
  alignas(8) unsigned char places[kPlacesMax][32] = {};  // the backend's
};

enum class LinkResult : std::uint8_t {
  done,    // of reading and writing: at least one byte
  later,   // nothing now; poll() tells when
  ended,   // the peer sends nothing more, and all it sent has been read; what is written may still reach it
  failed,  // for good (but see accept), `error` says why; the stream is the caller's to close
};

struct LinkOptions {
  void* memory = nullptr;               // the caller's, kept until close_all(); aligned as for malloc
  std::size_t memory_bytes = 0;         // at least need(stream_count_max)
  int stream_count_max = 0;             // 1 – kLinkStreamsMax
  std::uint64_t (*now_ns)() = nullptr;  // Backend::now_ns; the null link has its own clock
};

// What poll() is to wait for, and what it found.
struct LinkWait {
  int stream = -1;
  bool want_read = false;   // bytes, the end, a failure; of a listener, a connection to accept
  bool want_write = false;  // room for bytes, a failure; while connecting, the outcome
  bool can_read = false, can_write = false;
};

struct LinkBackend;
struct Link {
  const LinkBackend* backend;
};

struct LinkBackend {
  const char* name;
  // Bytes that a Link of so many streams takes.
  std::size_t (*need)(int stream_count_max);
  // Null: `error` says why.
  Link* (*open)(const LinkOptions& options, Error* error);

  // Reads "HOST:PORT", "[IPv6]:PORT", or ":PORT" and "PORT" for this machine alone. A name, unlike a number, is asked
  // of the system, which may take seconds and memory: resolve at the start, then connect as often as need be.
  bool (*resolve)(const char* text, LinkAddress* address, Error* error);
  // Begins to connect; the stream, or -1. It fails when `timeout_ns` have passed without an outcome.
  int (*connect)(Link* link, const LinkAddress& address, std::uint64_t timeout_ns, Error* error);
  // done: connected; later: not yet; failed.
  LinkResult (*connected)(Link* link, int stream, Error* error);
  // Waits for peers at the first place of the address, port 0 for any free one; the stream, or -1.
  int (*listen)(Link* link, const LinkAddress& address, Error* error);
  // Takes the next peer that waits. After `failed` the listener goes on: that peer is lost, the next may do better.
  LinkResult (*accept)(Link* link, int listener, int* stream, Error* error);
  // "HOST:PORT" in numbers: of a listener its own, of a connection the peer's. Valid until the stream is closed.
  const char* (*stream_name)(const Link* link, int stream);

  // Takes what has come, 1 – `byte_count_max` bytes.
  LinkResult (*read)(Link* link, int stream, void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                     Error* error);
  // Hands over what there is room for, perhaps less than all. `done` does not mean that the peer has it.
  LinkResult (*write)(Link* link, int stream, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                      Error* error);
  // Waits until one of the streams (at most stream_count_max, stale ones count as ready) can do what is wanted, or the
  // time is up. Returns how many can.
  int (*poll)(Link* link, LinkWait* waits, int wait_count, std::uint64_t timeout_ns);
  std::uint64_t (*now_ns)(Link* link);

  // What was written before still travels. Nothing happens to a stale stream.
  void (*close)(Link* link, int stream);
  // Closes every stream and gives the memory back.
  void (*close_all)(Link* link);
};

// Splits "HOST:PORT" as resolve() reads it; of an IPv6 address without its brackets. False: `error` says why.
bool link_parse_address(const char* text, char* host, std::size_t host_bytes, int* port, Error* error);

// Time that passes towards a deadline by a clock that may be set back: only its steps forward count.
struct LinkTimer {
  std::uint64_t last_ns = 0, passed_ns = 0, timeout_ns = 0;
};
inline LinkTimer link_timer(std::uint64_t now_ns, std::uint64_t timeout_ns) { return {now_ns, 0, timeout_ns}; }
// Nanoseconds that are left; 0: it is over.
inline std::uint64_t link_timer_left(LinkTimer* timer, std::uint64_t now_ns) {
  if (now_ns > timer->last_ns) timer->passed_ns += now_ns - timer->last_ns;
  timer->last_ns = now_ns;
  return timer->passed_ns < timer->timeout_ns ? timer->timeout_ns - timer->passed_ns : 0;
}

// Time by a clock that may be set back, which counts as if it had stood still. The same until it is.
struct LinkClock {
  std::uint64_t last_ns = 0, lost_ns = 0;
};
inline std::uint64_t link_clock_ns(LinkClock* clock, std::uint64_t now_ns) {
  if (now_ns < clock->last_ns) clock->lost_ns += clock->last_ns - now_ns;
  clock->last_ns = now_ns;
  return now_ns + clock->lost_ns;
}

}  // namespace platform
