// What a render server consists of, shared by the files that make it: server_guests.cpp lets clients in, server.cpp
// lets time pass and them go, server_messages.cpp understands them, server_work.cpp gives each its turn, server_job.cpp
// renders.
#pragma once
#include <vector>

#include "remote/server/log.h"
#include "remote/server/server.h"
#include "remote/server/session.h"

namespace pocketray {

constexpr int kAddressCountMax = 256;
constexpr std::size_t kGuestInputBytes = 272;  // any hello, also of another version

// Where connections come from, and what they have used together; kept when they have gone.
struct Address {
  std::uint64_t key = 0, last_ns = 0;  // seen last
  bool waits = false;
  Account account;
  Lanes lanes;  // of its sessions
};

// A connection without a place: it has not said hello yet, or has been told why it cannot stay and is given a moment to
// read it. Closed at once, what it has sent meanwhile would have the system throw the message away [RFC 1122,
// sec. 4.2.2.13].
struct Guest {
  MessageStream messages;
  bool leaves = false;
  std::uint64_t key = 0;                             // of its address
  platform::LinkTimer timer;                         // for its hello, or to leave
  std::uint8_t input[kGuestInputBytes], output[96];  // the stream's
};
inline bool is_open(const Guest& guest) { return guest.messages.stream >= 0; }

// The work that a session gets the CPU for.
struct Work {
  int session = -1, address = -1;  // -1: none
  bool is_job = false;
  int message_count = 0;
  std::uint64_t byte_count = 0;  // of the answers
  std::uint64_t job_number = 0;
  Slice slice = {};  // without pixels: a frame is prepared
  std::uint64_t begin_ns = 0, end_ns = 0;
  platform::LinkTimer timer;  // till the emulated CPU has done it
};

struct Server {
  ServerOptions options;
  const SceneStore* store = nullptr;
  platform::Link* link = nullptr;
  const platform::LinkBackend* net = nullptr;
  int listener = -1;
  bool accept_rests = false;  // the listener is not looked at until the timer is over
  platform::LinkTimer accept_timer;
  Workers* workers = nullptr;
  std::vector<Session> sessions;
  std::vector<void*> blocks;
  std::vector<Guest> guests;
  std::vector<Address> addresses;  // kAddressCountMax at most
  Lanes lanes;                     // of addresses
  std::vector<platform::LinkWait> waits;
  Work work;
  std::uint64_t cpu_free_ns = 0;  // when the emulated CPU has done its last work
  std::uint64_t settled_ns = 0;   // when accounts were looked at last
  std::uint32_t pixel_ps = 0;     // what a pixel cost a client, of late
  ServerLog log;
  ServerTotals totals;
};

inline std::uint64_t now_ns(Server* server) { return server->net->now_ns(server->link); }

// Whether messages are taken by whoever has the CPU, as on a real one. An emulated CPU takes them all at once where
// they cost it nothing.
inline bool in_turn(const Server& server) { return !is_paced(server.options.pace) || server.options.message_ns > 0; }

// ---- server_guests.cpp

void close_guest(Guest* guest);
// Lets in whoever waits at the listener.
void accept_clients(Server* server);
// Takes what a guest has sent: with a hello it gets a place, or is told that there is none.
void tend_guest(Server* server, Guest* guest);
// Drops what has come; false: nothing more will.
bool discard_input(MessageStream* messages);

// ---- server.cpp

// The client is told why, unless it has nothing to be told, and is closed when it has read that or a moment has passed.
void leave(Server* server, Session* session, const WireError* code, const char* reason);
// Closes its stream; its place is free.
void end_session(Server* server, Session* session, const char* reason);

// ---- server_messages.cpp

// Takes the bytes that a client has sent, as far as there is room.
void read_session(Server* server, Session* session);
// Takes messages off them for as long as a slice, as far as there is room to answer. Returns how many.
int take_messages(Server* server, Session* session);
Message server_hello(const Server& server);

// ---- server_work.cpp

// The CPU was busy for this client: with a frame, or else.
void account_for(Server* server, Session* session, std::uint64_t took_ns, bool is_job);
// Tells the client that a request of its is not met, and logs why.
void refuse(Server* server, Session* session, WireError code, std::uint32_t frame, const char* reason);
// Ends work that is done and begins the next: a part of the frame of the client that has used the CPU least.
void do_work(Server* server);
// Nanoseconds till do_work() has something to do; ~0: until somebody sends something.
std::uint64_t work_due_ns(Server* server);

}  // namespace pocketray
