// The simulated link: peers within one Link reach each other over a line of given bandwidth, latency and jitter, by a
// clock that advances only in poll() and now_ns(). Faults strike at given bytes; equal settings and calls always give
// equal events. The connecting end is the device: its connections share one full-duplex radio.
#pragma once
#include "platform/link.h"

namespace platform {

enum class LinkFault : std::uint8_t {
  refuse,      // the connection is refused; none of its bytes exists
  no_answer,   // connecting has no outcome
  reset,       // both ends fail; data in transit behind the byte is lost
  truncate,    // the sender fails, the receiver sees the end
  flip,        // one bit of the byte is flipped
  duplicate,   // the piece that begins with the byte arrives twice
  silence,     // nothing arrives any more, not even the end
  trickle,     // one byte a second from here on
  clock_back,  // the clock is set back by up to ten seconds
};
constexpr int kLinkFaultCount = 9;

// Strikes once in every connection to which it applies.
struct NullFault {
  LinkFault fault = LinkFault::reset;
  int connection = -1;        // index in the Link, from 0; -1: all
  bool to_device = true;      // in data from the accepting end; otherwise from the connecting end
  std::uint64_t at_byte = 0;  // strikes this byte of that direction
};

struct NullLinkSettings {
  std::uint64_t bytes_per_second = 0;  // each way; 0: no limit
  bool lines_apart = false;            // every connection has its own line; otherwise all share one radio
  std::uint64_t latency_ns = 0;        // one way
  std::uint64_t jitter_ns = 0;         // maximum addition for every piece; the order is kept
  std::uint32_t lost_per_million = 0;  // pieces lost and repeated; see lose_piece()
  std::size_t pipe_bytes = 65536;      // most bytes in transit in one direction of a connection, including unread bytes
  std::uint64_t clock_step_ns = 1000;  // advance of each now_ns(), so that busy-waiting loops end
  std::uint64_t seed = 1;              // for jitter, losses, flipped bits and steps of the clock
  const NullFault* faults = nullptr;   // from the caller, until close_all()
  int fault_count = 0;                 // at most kNullFaultsMax
};
constexpr int kNullFaultsMax = 32;

// The backend with custom settings; kNullLink itself has the defaults.
extern const LinkBackend kNullLink;
std::size_t null_link_need(int stream_count_max, const NullLinkSettings& settings);
Link* null_link_open(const LinkOptions& options, const NullLinkSettings& settings, Error* error);

// A connection from another machine: with its own address and its own radio of the settings' latency and unlimited
// bandwidth. Faults do not strike it, and connection_count leaves it out. `host` is a numeric address.
int null_link_connect_from(Link* link, const char* host, const LinkAddress& address, std::uint64_t timeout_ns,
                           Error* error);

struct NullLinkRecord {
  int connection_count = 0;  // requested so far
  int faults_struck = 0;
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;  // read
  std::uint64_t elapsed_ns = 0;                              // independent of the clock
};
NullLinkRecord null_link_record(const Link* link);

}  // namespace platform
