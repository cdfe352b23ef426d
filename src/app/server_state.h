// What a render server consists of, shared by the files that make it: server.cpp lets clients come and go and time
// pass, server_messages.cpp understands them, server_work.cpp renders for them.
#pragma once
#include <vector>

#include "app/server.h"
#include "app/server_log.h"
#include "app/server_session.h"

namespace pocketray {

constexpr int kGuestCountMax = 8;

// One that came when there was no place left: has been told so and is given a moment to read it. Closed at once, what
// it has sent meanwhile would have the system throw the message away [RFC 1122, sec. 4.2.2.13].
struct Guest {
  int stream = -1;
  platform::LinkTimer timer;
};

// The work that a session gets the CPU for.
struct Work {
  int session = -1;  // -1: none
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
  Workers* workers = nullptr;
  std::vector<Session> sessions;
  std::vector<void*> blocks;
  std::vector<Guest> guests;
  std::vector<platform::LinkWait> waits;
  Work work;
  std::uint64_t cpu_free_ns = 0;    // when the emulated CPU has done its last work
  std::uint64_t used_floor_ns = 0;  // who comes anew has used as much of the CPU as the one who was last to get it
  std::uint32_t pixel_ps = 0;       // what a pixel cost a client, of late
  ServerLog log;
  ServerTotals totals;
};

inline std::uint64_t now_ns(Server* server) { return server->net->now_ns(server->link); }

// ---- server.cpp

// The client is told why, unless it has nothing to be told, and is closed when it has read that or a moment has passed.
void leave(Server* server, Session* session, const WireError* code, const char* reason);
// Closes its stream; its place is free.
void end_session(Server* server, Session* session, const char* reason);

// ---- server_messages.cpp

// Takes what a client has sent, as far as there is room to answer.
void read_session(Server* server, Session* session);
Message server_hello(const Server& server);

// ---- server_work.cpp

// Tells the client that a request of its is not met, and logs why.
void refuse(Server* server, Session* session, WireError code, std::uint32_t frame, const char* reason);
// Ends work that is done and begins the next: a part of the frame of the client that has used the CPU least.
void do_work(Server* server);
// Nanoseconds till do_work() has something to do; ~0: until somebody sends something.
std::uint64_t work_due_ns(Server* server);

}  // namespace pocketray
