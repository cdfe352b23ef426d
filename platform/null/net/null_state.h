// State of a simulated link, shared by its sources: null_connect.cpp begins and ends connections, null_link.cpp carries
// their bytes.
#pragma once
#include <cstdio>

#include "platform/net/link_pipe.h"
#include "platform/net/link_slots.h"
#include "platform/null/net/null_link.h"

namespace platform {
namespace null_link {

enum class Phase : std::uint8_t { unused, listening, connecting, waiting, connected, broken };

// A listener, or an end of a connection. `waiting` is the accepting end until it is accepted.
struct Slot {
  Phase phase;
  bool device;            // the connecting end
  bool elsewhere;         // part of a connection from another machine
  int generation;         // counts the streams in this slot, which exposes stale ones
  int other;              // slot of the other end; -1: closed, or there never was one
  int listener;           // of a waiting end
  int port, connection;   // connection: index in the Link
  bool refused;           // the outcome, once known
  std::uint64_t news_ns;  // when the outcome of connecting is known, or when a waiting peer is seen
  std::uint64_t deadline_ns;
  LinkPipe in;
  const char* broken_text;
  char name[40];
};

struct alignas(Slot) NullLink : Link {  // followed by its slots
  NullLinkSettings settings;
  NullLinkRecord record;
  std::uint64_t clock_ns, set_back_ns;
  std::uint64_t line_free_ns[2];  // until when the radio is busy, by direction
  std::uint64_t random;
  int slot_count, port_last;
  Slot* slots;
};

// The clock starts where setting it back cannot make it negative: at most kNullFaultsMax times ten seconds per
// connection.
constexpr std::uint64_t kClockStartNs = std::uint64_t{1} << 62;

inline NullLink* null(Link* link) { return static_cast<NullLink*>(link); }

inline Slot* slot_of(NullLink* link, int stream) {
  Slot* slot = slot_at(link->slots, link->slot_count, stream);
  return slot && slot->phase != Phase::waiting ? slot : nullptr;
}

inline int index_of(const NullLink* link, const Slot* slot) { return static_cast<int>(slot - link->slots); }
inline int stream_of(const NullLink* link, const Slot* slot) { return stream_number(link->slots, slot); }

inline LinkResult fail(Slot* slot, const char* text, Error* error) {
  slot->phase = Phase::broken;
  slot->broken_text = text;
  std::snprintf(error->text, sizeof error->text, "%s: %s", slot->name, text);
  return LinkResult::failed;
}

constexpr const char* kRefusedText = "nothing is listening there: start `pocketray serve`, or name another port";
constexpr const char* kSilentText =
    "no answer: is it on and within reach, and does its firewall let this port through?";
constexpr const char* kBrokenText = "the peer closed the connection: it was stopped, or rejected what it received";

inline bool meant_for(const NullFault& fault, const Slot& slot) {
  if (slot.elsewhere) return false;
  return fault.connection < 0 || fault.connection == slot.connection;
}
inline bool at_start(LinkFault fault) { return fault == LinkFault::refuse || fault == LinkFault::no_answer; }

// Advances connecting.
LinkResult progress(NullLink* link, Slot* slot, Error* error);
// Returns the peer that has waited longest, or null; its news_ns may lie in the future.
Slot* waiting_at(NullLink* link, const Slot* listener);

// kNullLink's resolve().
bool resolve(const char* text, LinkAddress* address, Error* error);
int listen(Link* base, const LinkAddress& address, Error* error);
int connect(Link* base, const LinkAddress& address, std::uint64_t timeout_ns, Error* error);
LinkResult connected(Link* base, int stream, Error* error);
LinkResult accept(Link* base, int listener, int* stream, Error* error);
void close_stream(Link* base, int stream);
void close_all(Link* base);

}  // namespace null_link
}  // namespace platform
