// State of a render server, shared by its files: guests.cpp admits clients, places.cpp assigns places, server.cpp
// handles time-outs and departures, messages.cpp handles messages, work.cpp gives each client its turn, job.cpp
// renders.
#pragma once
#include <vector>

#include "remote/server/log.h"
#include "remote/server/server.h"
#include "remote/server/session.h"

namespace pocketray {

// Chosen: besides kServerClientsMax addresses in use, 192 that have gone keep their accounts. With fewer, a client
// could shed its debt sooner by returning after others; more take longer to search.
constexpr int kAddressCountMax = 256;
// Any hello, even of another version. Derived: 8 + 256 bytes (PROTOCOL.md), rounded up to 16.
constexpr std::size_t kGuestInputBytes = 272;

// An address of connections and their combined CPU use; kept after they have gone.
struct Address {
  std::uint64_t key = 0, last_ns = 0;  // last_ns: last seen
  bool waits = false;
  Account account;
  Lanes lanes;  // of its sessions
};

// A connection without a place: before its hello, or told why it cannot stay and given a moment to read that. If closed
// at once, its unread input would make the system discard the message [RFC 1122, sec. 4.2.2.13].
struct Guest {
  MessageStream messages;
  bool leaves = false;
  std::uint64_t key = 0;                             // of its address
  platform::LinkTimer timer;                         // for its hello or for leaving
  std::uint8_t input[kGuestInputBytes], output[96];  // the stream's
};
inline bool is_open(const Guest& guest) { return guest.messages.stream >= 0; }

// The work for which a session has the CPU.
struct Work {
  int session = -1, address = -1;  // -1: none
  bool is_job = false;
  int message_count = 0;
  std::uint64_t byte_count = 0;  // of the answers
  std::uint64_t job_number = 0;
  Slice slice = {};       // without pixels: preparing a frame
  bool is_build = false;  // prepares the renderer for later frames
  std::uint64_t begin_ns = 0, end_ns = 0;
  std::uint64_t cpu_ns = 0;   // to charge
  platform::LinkTimer timer;  // until the emulated CPU has done it
};

struct Server {
  ServerOptions options;
  const SceneStore* store = nullptr;
  platform::Link* link = nullptr;
  const platform::LinkBackend* net = nullptr;
  int listener = -1;
  bool accept_rests = false;  // the listener is not polled until the timer expires
  platform::LinkTimer accept_timer;
  platform::LinkTimer guest_rest;  // until then, guests wait for work of the sessions
  std::uint64_t seat_count = 0;    // given
  Workers* workers = nullptr;
  std::vector<Session> sessions;
  std::vector<void*> blocks;
  std::vector<Guest> guests;
  std::vector<Address> addresses;  // kAddressCountMax at most
  Lanes lanes;                     // of addresses
  std::vector<platform::LinkWait> waits;
  Work work;
  std::uint64_t cpu_free_ns = 0;  // when the emulated CPU finishes its last work
  std::uint64_t settled_ns = 0;   // when accounts were last settled
  std::uint32_t pixel_ps = 0;     // recent work on a pixel
  ServerLog log;
  ServerTotals totals;
};

inline std::uint64_t now_ns(Server* server) { return server->net->now_ns(server->link); }

// The clock that measures CPU time.
inline std::uint64_t cpu_now_ns(Server* server) {
  return server->options.cpu_ns ? server->options.cpu_ns() : now_ns(server);
}

// True if only the session with the CPU handles messages, as on a real CPU. An emulated CPU for which messages are free
// handles them all at once.
inline bool in_turn(const Server& server) { return !is_paced(server.options.pace) || server.options.message_ns > 0; }

// ---- guests.cpp

void close_guest(Guest* guest);
// Tends all guests and accepts more if `comes`, unless that has to wait.
void tend_guests(Server* server, bool comes);
// Drops pending input; returns false if the peer has closed.
bool discard_input(MessageStream* messages);

// ---- places.cpp

// Number of places that an address has.
int places_of(const Server& server, int address);
// Returns a free place for a newcomer of that address, or one whose session had to leave; null if there is none.
Session* find_place(Server* server, int address);

// ---- server.cpp

// Tells the client why, unless code is null, and closes it once it has read that or after a moment.
void leave(Server* server, Session* session, const WireError* code, const char* reason);
// Closes its stream and frees its place.
void end_session(Server* server, Session* session, const char* reason);

// ---- messages.cpp

// Reads a client's input as far as there is room.
void read_session(Server* server, Session* session);
// Handles messages for up to a slice, as far as there is room to answer. Returns their number.
int take_messages(Server* server, Session* session);
// Hello to a guest of that address.
Message server_hello(const Server& server, std::uint64_t address_key);

// ---- work.cpp

// Charges CPU time to this client, for a frame or otherwise.
void account_for(Server* server, Session* session, std::uint64_t took_ns, bool is_job);
// Price of the server's time for one more connection of that address.
std::uint16_t newcomer_price(const Server& server, std::uint64_t address_key);
// Tells the client that a request is refused, and logs why.
void refuse(Server* server, Session* session, WireError code, std::uint32_t frame, const char* reason);
// Ends finished work and begins the next: a part of a frame for the client that has used the CPU least.
void do_work(Server* server);
// Nanoseconds until do_work() has something to do; ~0: not before new input.
std::uint64_t work_due_ns(Server* server);

}  // namespace pocketray
