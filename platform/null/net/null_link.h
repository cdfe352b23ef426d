// The simulated link: peers within one Link reach each other over a line of given bandwidth, latency and jitter, by a
// clock that runs only in poll() and now_ns(). Faults strike at given bytes; the same settings and calls give the same
// course, always. Whoever connects is taken for the device: its connections share one radio, which sends and receives
// at once.
#pragma once
#include "platform/link.h"

namespace platform {

enum class LinkFault : std::uint8_t {
  refuse,      // the connection is refused; no byte of it exists
  no_answer,   // the connection comes to no outcome
  reset,       // both ends fail; what is underway behind the byte is lost
  truncate,    // the sender fails, the receiver sees the end
  flip,        // one bit of the byte is flipped
  duplicate,   // the piece that begins with the byte comes twice
  silence,     // nothing comes any more, and no end
  trickle,     // one byte a second from here on
  clock_back,  // the clock is set back by up to ten seconds
};
constexpr int kLinkFaultCount = 9;

// Strikes once in every connection that it is meant for.
struct NullFault {
  LinkFault fault = LinkFault::reset;
  int connection = -1;        // the how manieth of the Link, from 0; -1: all
  bool to_device = true;      // of what the accepting end sends; else of what the connecting one does
  std::uint64_t at_byte = 0;  // strikes this byte of that direction
};

struct NullLinkSettings {
  std::uint64_t bytes_per_second = 0;  // 0: no limit
  std::uint64_t latency_ns = 0;        // one way
  std::uint64_t jitter_ns = 0;         // up to so much more, for every piece; the order stays
  std::size_t pipe_bytes = 65536;      // underway in one direction of a connection at most, unread ones included
  std::uint64_t clock_step_ns = 1000;  // by each now_ns(), so that loops that wait come to an end
  std::uint64_t seed = 1;              // of jitter, flipped bits and steps of the clock
  const NullFault* faults = nullptr;   // the caller's, kept until close_all()
  int fault_count = 0;                 // at most kNullFaultsMax
};
constexpr int kNullFaultsMax = 32;

// With settings of one's own; kNullLink itself has those above.
extern const LinkBackend kNullLink;
std::size_t null_link_need(int stream_count_max, const NullLinkSettings& settings);
Link* null_link_open(const LinkOptions& options, const NullLinkSettings& settings, Error* error);

// A connection from another machine: with its own address and its own radio, which has the latency of the settings and
// no limit of bandwidth; faults do not strike it and connection_count leaves it out. `host` is an address in numbers.
int null_link_connect_from(Link* link, const char* host, const LinkAddress& address, std::uint64_t timeout_ns,
                           Error* error);

struct NullLinkRecord {
  int connection_count = 0;  // asked for so far
  int faults_struck = 0;
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;  // read
  std::uint64_t elapsed_ns = 0;                              // whatever the clock says
};
NullLinkRecord null_link_record(const Link* link);

}  // namespace platform
