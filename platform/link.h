// The link contract: byte streams to peers, as one struct of functions per backend. Standard types only. net/tcp.h has
// the real one, null/net/null_link.h one with a virtual clock and faults.
//
// A Link lies in memory from the caller, is used from one thread and takes no other memory after open(). There may be
// several. Only poll() waits, up to its timeout, and resolve(), as long as the system's resolver does. A stream is a
// number ≥ 0 for a connection or a listener, until close(); after that it is stale, and every call with it fails.
#pragma once
#include <cstddef>
#include <cstdint>

#include "platform/platform.h"

namespace platform {

constexpr int kLinkStreamsMax = 256;  // of one Link, including listeners
constexpr std::size_t kLinkNameBytes = 96;

// Address of a peer, or address on which to wait for peers.
struct LinkAddress {
  static constexpr int kPlacesMax = 4;
  char text[kLinkNameBytes] = {0};                       // as given, for messages
  bool loopback = false;                                 // all places are on this machine
  int place_count = 0;                                   // a name may have several; connect() tries one after the other
  alignas(8) unsigned char places[kPlacesMax][32] = {};  // in the backend's format
};

enum class LinkResult : std::uint8_t {
  done,    // reading and writing: at least one byte
  later,   // nothing now; poll() tells when
  ended,   // the peer will send nothing more, and all of it has been read; writes may still reach the peer
  failed,  // permanently (but see accept), `error` says why; the caller must close the stream
};

struct LinkOptions {
  void* memory = nullptr;               // from the caller, until close_all(); aligned as for malloc
  std::size_t memory_bytes = 0;         // at least need(stream_count_max)
  int stream_count_max = 0;             // 1 – kLinkStreamsMax
  std::uint64_t (*now_ns)() = nullptr;  // Backend::now_ns; the null link has its own clock
};

// Input and result of poll().
struct LinkWait {
  int stream = -1;
  bool want_read = false;   // bytes, the end or a failure; for a listener, a connection to accept
  bool want_write = false;  // room for bytes or a failure; while connecting, the outcome
  bool can_read = false, can_write = false;
};

struct LinkBackend;
struct Link {
  const LinkBackend* backend;
};

struct LinkBackend {
  const char* name;
  // Bytes that a Link of that many streams takes.
  std::size_t (*need)(int stream_count_max);
  // Returns null on failure; `error` says why.
  Link* (*open)(const LinkOptions& options, Error* error);

  // Parses "HOST:PORT", "[IPv6]:PORT", or ":PORT" and "PORT" for this machine only. Looking up a name, unlike a number,
  // may take seconds and memory: resolve at the start, then connect as often as necessary.
  bool (*resolve)(const char* text, LinkAddress* address, Error* error);
  // Begins to connect; returns the stream, or -1, with an error that may begin with the address as given and ": ". The
  // connection fails after `timeout_ns` without an outcome.
  int (*connect)(Link* link, const LinkAddress& address, std::uint64_t timeout_ns, Error* error);
  // done: connected; later: not yet; failed.
  LinkResult (*connected)(Link* link, int stream, Error* error);
  // Listens at the first place of the address, port 0 for any free one; returns the stream, or -1.
  int (*listen)(Link* link, const LinkAddress& address, Error* error);
  // Accepts the next waiting peer. After `failed` the listener remains usable: only that peer is lost.
  LinkResult (*accept)(Link* link, int listener, int* stream, Error* error);
  // Returns "HOST:PORT" in numbers: a listener's own, or a connection's peer; while connecting, the address as given.
  // Valid until the stream is closed. Errors of a stream begin with it and ": ".
  const char* (*stream_name)(const Link* link, int stream);

  // Reads available bytes, 1 – `byte_count_max` of them.
  LinkResult (*read)(Link* link, int stream, void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                     Error* error);
  // Writes as much as there is room for, perhaps less than all. `done` does not mean that the peer has received it.
  LinkResult (*write)(Link* link, int stream, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count,
                      Error* error);
  // Waits until one of the streams (at most stream_count_max; stale ones count as ready) is ready, or for the timeout.
  // Returns how many are ready.
  int (*poll)(Link* link, LinkWait* waits, int wait_count, std::uint64_t timeout_ns);
  std::uint64_t (*now_ns)(Link* link);

  // Data written before is still delivered. Does nothing to a stale stream.
  void (*close)(Link* link, int stream);
  // Closes every stream and returns the memory.
  void (*close_all)(Link* link);
};

// Divides "HOST:PORT" as resolve() reads it; an IPv6 host loses its brackets. Returns false with the reason in `error`.
bool link_parse_address(const char* text, char* host, std::size_t host_bytes, int* port, Error* error);

// Measures time until a deadline by a clock that may be set back: only its forward steps count.
struct LinkTimer {
  std::uint64_t last_ns = 0, passed_ns = 0, timeout_ns = 0;
};
inline LinkTimer link_timer(std::uint64_t now_ns, std::uint64_t timeout_ns) { return {now_ns, 0, timeout_ns}; }
// Nanoseconds left; 0 when time is up.
inline std::uint64_t link_timer_left(LinkTimer* timer, std::uint64_t now_ns) {
  if (now_ns > timer->last_ns) timer->passed_ns += now_ns - timer->last_ns;
  timer->last_ns = now_ns;
  return timer->passed_ns < timer->timeout_ns ? timer->timeout_ns - timer->passed_ns : 0;
}

// Time from a clock that may be set back; such steps are ignored.
struct LinkClock {
  std::uint64_t last_ns = 0, lost_ns = 0;
};
inline std::uint64_t link_clock_ns(LinkClock* clock, std::uint64_t now_ns) {
  if (now_ns < clock->last_ns) clock->lost_ns += clock->last_ns - now_ns;
  clock->last_ns = now_ns;
  return now_ns + clock->lost_ns;
}

}  // namespace platform
