// Shared by the files of the encrypted link: tls_link.cpp handles connections, tls_poll.cpp waiting.
#pragma once
#include "platform/net/link_slots.h"
#include "platform/net/tls/tls_link.h"
#include "platform/net/tls/tls_stream.h"

namespace platform {

// `closing`: the last record still has to find room. `broken`: the stream below is closed.
enum class TlsPhase : std::uint8_t { unused, listening, connecting, greeting, connected, closing, broken };

struct TlsSlot {
  TlsPhase phase;
  int generation;
  int inner;        // the inner stream; -1: closed
  bool accepted;    // by a listener here
  bool ended;       // the peer said farewell
  LinkTimer timer;  // for the handshake, and when closing
  TlsStream tls;
  unsigned char* memory;      // kTlsStreamHeapBytes
  Error error;                // why it is broken
  char name[kLinkNameBytes];  // once the inner stream is closed, and for errors
};

struct alignas(TlsSlot) TlsLink : Link {  // followed by its slots, waits and heaps
  LinkBackend functions;
  Link* inner;
  TlsConfig config;
  int slot_count;
  int turn;        // the slot whose handshake goes first
  LinkTimer rest;  // until the next step of an accepted peer's handshake
  TlsSlot* slots;
  LinkWait* waits;  // for the inner poll(), one per slot
  TlsLinkRecord record;
};

inline TlsLink* tls_of(Link* link) { return static_cast<TlsLink*>(link); }
inline const LinkBackend& net(const TlsLink* link) { return *link->inner->backend; }
inline std::uint64_t now_of(TlsLink* link) { return net(link).now_ns(link->inner); }

// Returns null if stale.
inline TlsSlot* tls_slot_of(TlsLink* link, int stream) {
  TlsSlot* slot = slot_at(link->slots, link->slot_count, stream);
  return slot && slot->phase != TlsPhase::closing ? slot : nullptr;
}

// ---- tls_link.cpp

// Advances the handshake.
LinkResult tls_greet(TlsLink* link, TlsSlot* slot, Error* error);
// Advances connecting.
LinkResult tls_progress(TlsLink* link, TlsSlot* slot, Error* error);
// Call when the library has failed: says why and gives up the connection.
LinkResult tls_fail(TlsLink* link, TlsSlot* slot, Error* error);
// Call when the time for the handshake is up.
LinkResult tls_fail_in_time(TlsLink* link, TlsSlot* slot, Error* error);
// Frees a slot that is closing, whatever it still holds.
void tls_free_closing(TlsLink* link, TlsSlot* slot);

// ---- tls_poll.cpp

// Implements the link's poll().
int tls_poll(Link* base, LinkWait* waits, int wait_count, std::uint64_t timeout_ns);

}  // namespace platform
