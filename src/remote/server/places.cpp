// Assigns places. If all are taken, an address with more places than the newcomer's gives one up, and misbehaving
// clients make way for others.
#include <algorithm>

#include "base/check.h"
#include "remote/server/state.h"

namespace pocketray {
namespace {

// Silence after which a client makes way for another. Chosen: longer than a person pauses between two frames.
constexpr std::uint64_t kMakeWayNs = 10'000'000'000;
// Derived: a device gives up a server that sends no rows for 3 s (client.h).
constexpr std::uint64_t kUnprovenNs = 3'000'000'000;  // time to be sent a light frame

struct Newcomer {
  int address, place_count;  // place_count: of its address
  bool behaves;              // its address behaves
  bool is_known;             // its address has no place, but has been sent light frames
  bool is_new;               // its address has never had a place
  bool yields_to_proven;     // its address has sessions that have not been sent light frames
};

// In order of leaving, the first to leave last.
enum class Standing : std::uint8_t { behaves, misbehaves_though_proven, address_misbehaves, misbehaves };

struct Candidate {
  Session* session = nullptr;
  Standing standing = Standing::behaves;
  int place_count = 0;  // of its address
  bool is_proven = false;
  bool is_idle = false, is_in_vain = false;  // longer than above
  std::uint64_t offence_ns = 0, silent_ns = 0;
};

Address& address_of(Server* server, const Session& session) {
  CHECK(session.address >= 0 && session.address < static_cast<int>(server->addresses.size()));
  return server->addresses[static_cast<std::size_t>(session.address)];
}

// A frame that takes too long to be light counts before its end.
std::uint64_t offence_ns(const Session& session) {
  const FrameJob& job = session.job;
  const bool is_heavy = has_job(session) && job.took_ns > kLightNs + job.build_ns;
  return offence_ns(session.account, is_heavy ? job.took_ns : 0);
}

std::uint64_t silent_ns(Server* server, Session* session) {
  std::uint64_t left = platform::link_timer_left(&session->idle_timer, now_ns(server));
  return server->options.idle_timeout_ns - std::min(left, server->options.idle_timeout_ns);
}

Newcomer newcomer_of(const Server& server, int address) {
  const Account& account = server.addresses[static_cast<std::size_t>(address)].account;
  Newcomer n = {address, places_of(server, address), offence_ns(account, 0) == 0, false, account.seat == 0, false};
  n.is_known = n.place_count == 0 && n.behaves && is_proven(account);
  n.yields_to_proven = std::any_of(server.sessions.begin(), server.sessions.end(), [&](const Session& session) {
    return session.phase != SessionPhase::unused && session.address == address && !is_proven(session.account);
  });
  return n;
}

Candidate candidate_of(Server* server, Session* session) {
  Candidate c;
  c.session = session;
  c.place_count = places_of(*server, session->address);
  c.is_proven = is_proven(session->account);
  c.offence_ns = offence_ns(*session);
  c.silent_ns = silent_ns(server, session);
  if (c.offence_ns > 0)
    c.standing = c.is_proven ? Standing::misbehaves_though_proven : Standing::misbehaves;
  else if (!c.is_proven && offence_ns(address_of(server, *session).account, 0) > 0)
    c.standing = Standing::address_misbehaves;
  c.is_idle = session->phase == SessionPhase::leaving || (!has_job(*session) && c.silent_ns >= kMakeWayNs);
  c.is_in_vain =
      !c.is_proven && queued_bytes(session->messages) == 0 && now_ns(server) - session->seated_ns >= kUnprovenNs;
  return c;
}

// Any client of an address with at least two more places may have to leave, and an idle client of one with more places.
// Within an address, clients that have behaved keep their places from newcomers while others have not been sent a light
// frame. At other addresses, misbehaving clients may have to leave, and clients that have not been sent a light frame
// for a while (at once if the newcomer's address has).
bool may_go(const Candidate& c, const Newcomer& n) {
  if (c.session->address == n.address) {
    const bool misbehaves = c.standing == Standing::misbehaves || c.standing == Standing::misbehaves_though_proven;
    return (c.is_idle || misbehaves) && !(n.yields_to_proven && c.is_proven);
  }
  if (c.place_count >= n.place_count + 2 || (c.is_idle && c.place_count > n.place_count)) return true;
  if (n.is_known && !c.is_proven) return true;
  return (n.behaves && c.standing != Standing::behaves) || (n.is_new && c.is_in_vain);
}

// The worst standing leaves first; then the address with most places; then the client that has not been sent light
// frames, was silent the longest or came last.
bool leaves_before(const Candidate& a, const Candidate& b) {
  if (a.standing != b.standing) return a.standing > b.standing;
  if (a.offence_ns != b.offence_ns) return a.offence_ns > b.offence_ns;
  if (a.place_count != b.place_count) return a.place_count > b.place_count;
  if (a.is_proven != b.is_proven) return b.is_proven;
  if (a.silent_ns != b.silent_ns) return a.silent_ns > b.silent_ns;
  return a.session->account.seat > b.session->account.seat;
}

// Returns the session that must leave for one of `address`; null if none.
Session* find_leaver(Server* server, int address) {
  const Newcomer newcomer = newcomer_of(*server, address);
  Candidate chosen;
  for (Session& session : server->sessions) {
    if (session.phase == SessionPhase::unused) continue;
    if (session.messages.ended) return &session;  // nobody would receive the answers to what it has sent
    const Candidate c = candidate_of(server, &session);
    if (may_go(c, newcomer) && (!chosen.session || leaves_before(c, chosen))) chosen = c;
  }
  return chosen.session;
}

}  // namespace

int places_of(const Server& server, int address) {
  CHECK_GE(address, 0);
  return static_cast<int>(std::count_if(server.sessions.begin(), server.sessions.end(), [&](const Session& session) {
    return session.phase != SessionPhase::unused && session.address == address;
  }));
}

Session* find_place(Server* server, int address) {
  CHECK(address >= 0 && address < static_cast<int>(server->addresses.size()));
  for (Session& session : server->sessions)
    if (session.phase == SessionPhase::unused) return &session;
  Session* leaver = find_leaver(server, address);
  if (!leaver) return nullptr;
  if (leaver->phase == SessionPhase::serving && output_room(leaver->messages) >= kReplyBytesMax) {
    send_error(leaver, WireError::busy, 0);
    platform::Error error;
    (void)flush_message_stream(&leaver->messages, &error);
    discard_input(&leaver->messages);
  }
  end_session(server, leaver, "it made way for another client");
  return leaver;
}

}  // namespace pocketray
