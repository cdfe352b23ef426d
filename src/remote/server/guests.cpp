// Who is let in: connections become guests, guests that say hello get a place. Where all places are taken, an address
// that has more of them than the newcomer's gives one up.
#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "remote/server/state.h"

namespace pocketray {
namespace {

using platform::LinkResult;

constexpr std::uint64_t kLingerNs = 2'000'000'000;      // for who leaves to read why
constexpr std::uint64_t kMakeWayNs = 10'000'000'000;    // of silence, after which a client makes way for another
constexpr std::uint64_t kAcceptRestNs = 1'000'000'000;  // after a failure: what is missing will still be, at once
constexpr int kAcceptsAtOnce = 16;

void queue(Guest* guest, const Message& message) {
  std::uint32_t byte_count = message_bytes(message);
  CHECK_GE(guest->stream, 0);
  CHECK_LE(guest->output_end + byte_count, sizeof guest->output);
  encode_message(message, guest->output + guest->output_end);
  guest->output_end += byte_count;
}

// Sends what there is room for; false: the connection is lost.
bool flush(Server* server, Guest* guest) {
  while (guest->output_begin < guest->output_end) {
    std::size_t sent = 0;
    platform::Error error;
    LinkResult result = server->net->write(server->link, guest->stream, guest->output + guest->output_begin,
                                           guest->output_end - guest->output_begin, &sent, &error);
    if (result != LinkResult::done) return result == LinkResult::later;
    guest->output_begin += sent;
    CHECK_LE(guest->output_begin, guest->output_end);  // a link sends no more than it is given
  }
  return true;
}

void send_away(Server* server, Guest* guest, WireError code) {
  CHECK(!guest->leaves);
  Message message;
  message.type = MessageType::error;
  message.error.code = code;
  queue(guest, message);
  guest->leaves = true;
  guest->timer = platform::link_timer(now_ns(server), kLingerNs);
  if (!flush(server, guest)) close_guest(server, guest);
}

int guests_of(const Server& server, std::uint64_t key) {
  return static_cast<int>(std::count_if(server.guests.begin(), server.guests.end(),
                                        [&](const Guest& g) { return g.stream >= 0 && g.key == key; }));
}

// A free slot, or that of the one that has waited longest of those that leave or, else, of the address with most.
Guest* free_guest(Server* server) {
  Guest* chosen = nullptr;
  int most = 0;
  std::uint64_t least = 0;
  for (Guest& guest : server->guests) {
    if (guest.stream < 0) return &guest;
    int count = guest.leaves ? kAddressCountMax : guests_of(*server, guest.key);
    std::uint64_t left = platform::link_timer_left(&guest.timer, now_ns(server));
    if (count < most || (count == most && left >= least)) continue;
    chosen = &guest, most = count, least = left;
  }
  CHECK(chosen != nullptr);  // there is room for one at least
  close_guest(server, chosen);
  return chosen;
}

void receive_guest(Server* server, int stream) {
  CHECK_GE(stream, 0);
  Guest* guest = free_guest(server);
  *guest = Guest();
  guest->stream = stream;
  guest->key = address_key(server->net->stream_name(server->link, stream));
  guest->timer = platform::link_timer(now_ns(server), server->options.message_timeout_ns);
  queue(guest, server_hello(*server));
  if (!flush(server, guest)) close_guest(server, guest);
}

// Of the addresses that nobody is at the one that was seen longest ago.
int forgotten_address(const Server& server) {
  const std::vector<Address>& all = server.addresses;
  int oldest = -1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    bool taken = std::any_of(server.sessions.begin(), server.sessions.end(), [&](const Session& session) {
      return session.phase != SessionPhase::unused && session.address == static_cast<int>(i);
    });
    if (!taken && (oldest < 0 || all[i].last_ns < all[static_cast<std::size_t>(oldest)].last_ns))
      oldest = static_cast<int>(i);
  }
  CHECK_GE(oldest, 0);  // there are more of them than sessions
  return oldest;
}

// The account of an address: its own, or else a new one, if need be that of another.
int find_address(Server* server, std::uint64_t key) {
  std::vector<Address>& all = server->addresses;
  CHECK_LE(all.size(), std::size_t(kAddressCountMax));
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].key == key) return static_cast<int>(i);
  int chosen = static_cast<int>(all.size());
  if (chosen < kAddressCountMax) {
    all.emplace_back();
  } else {
    chosen = forgotten_address(*server);
    for (Session& session : server->sessions)
      if (session.address == chosen) session.address = -1;
    all[static_cast<std::size_t>(chosen)] = Address();
  }
  all[static_cast<std::size_t>(chosen)].key = key;
  return chosen;
}

int places_of(const Server& server, int address) {
  return static_cast<int>(std::count_if(server.sessions.begin(), server.sessions.end(), [&](const Session& session) {
    return session.phase != SessionPhase::unused && session.address == address;
  }));
}

std::uint64_t silent_ns(Server* server, Session* session) {
  std::uint64_t left = platform::link_timer_left(&session->idle_timer, now_ns(server));
  return server->options.idle_timeout_ns - std::min(left, server->options.idle_timeout_ns);
}

// Who has to go for one of `address` to come: of the address with most places the one that has been silent longest, if
// that address has two more, or if it is idle and has more, or is the newcomer's own. Null: nobody.
Session* find_leaver(Server* server, int address) {
  int own = places_of(*server, address), most = 0;
  std::uint64_t longest = 0;
  Session* chosen = nullptr;
  for (Session& session : server->sessions) {
    if (session.phase == SessionPhase::unused) continue;
    int count = places_of(*server, session.address);
    std::uint64_t silent = silent_ns(server, &session);
    bool idle = session.phase == SessionPhase::leaving || (!has_job(session) && silent >= kMakeWayNs);
    bool may_go = count >= own + 2 || (idle && (count > own || session.address == address));
    if (!may_go || count < most || (count == most && chosen && silent <= longest)) continue;
    chosen = &session, most = count, longest = silent;
  }
  return chosen;
}

Session* find_place(Server* server, int address) {
  for (Session& session : server->sessions)
    if (session.phase == SessionPhase::unused) return &session;
  Session* leaver = find_leaver(server, address);
  if (!leaver) return nullptr;
  if (leaver->phase == SessionPhase::serving && output_room(*leaver) >= kReplyBytesMax) {
    send_error(leaver, WireError::busy, 0);
    std::size_t sent = 0;
    platform::Error error;
    OutputQueue* q = &leaver->output;
    (void)server->net->write(server->link, leaver->stream, q->bytes.data + q->begin, q->end - q->begin, &sent, &error);
    drop_input(server, leaver->stream);
  }
  end_session(server, leaver, "it made way for another client");
  return leaver;
}

// Gives the guest's connection a place.
void seat(Server* server, Guest* guest, const Hello& hello) {
  int address = find_address(server, guest->key);
  Session* session = find_place(server, address);
  if (!session) {
    log_line(&server->log, now_ns(server), "%s was sent away: all %zu places are taken",
             server->net->stream_name(server->link, guest->stream), server->sessions.size());
    return send_away(server, guest, WireError::busy);
  }
  restart_session(session);
  session->phase = SessionPhase::serving;
  session->stream = guest->stream;
  session->address = address;
  session->message_bytes_max = hello.message_bytes_max;
  std::snprintf(session->name, sizeof session->name, "%s", server->net->stream_name(server->link, session->stream));
  std::uint64_t now = now_ns(server);
  server->addresses[static_cast<std::size_t>(address)].last_ns = now;
  session->message_timer = platform::link_timer(now, server->options.message_timeout_ns);
  session->idle_timer = platform::link_timer(now, server->options.idle_timeout_ns);
  session->stall_timer = platform::link_timer(now, server->options.stall_timeout_ns);
  std::size_t unsent = guest->output_end - guest->output_begin;
  std::memcpy(reserve_output(session, unsent), guest->output + guest->output_begin, unsent);
  session->output.end += unsent;
  guest->stream = -1;
  ++server->totals.client_count;
  log_line(&server->log, now, "%s came", session->name);
}

void log_guest(Server* server, const Guest& guest, const char* reason) {
  log_line(&server->log, now_ns(server), "%s went: %s", server->net->stream_name(server->link, guest.stream), reason);
}

// Reads the first message and not a byte of what follows it, which the session is to take.
void read_hello(Server* server, Guest* guest) {
  for (;;) {
    Message message;
    Decoded decoded = decode_message(guest->input, guest->input_count, kGuestInputBytes, &message);
    if (decoded.state == DecodeState::message && message.type == MessageType::hello) {
      if (message.hello.version == kWireVersion) return seat(server, guest, message.hello);
      log_guest(server, *guest, "it speaks another version of the protocol");
      return send_away(server, guest, WireError::wrong_version);
    }
    bool too_long = decoded.byte_count > kGuestInputBytes;
    if (decoded.state != DecodeState::need_more || too_long) {
      log_guest(server, *guest, "it did not begin with a hello");
      return send_away(server, guest, WireError::malformed);
    }
    std::size_t count = 0;
    platform::Error error;
    LinkResult result = server->net->read(server->link, guest->stream, guest->input + guest->input_count,
                                          decoded.byte_count - guest->input_count, &count, &error);
    guest->input_count += count;
    if (result == LinkResult::later) return;
    if (result == LinkResult::done) continue;
    log_guest(server, *guest, result == LinkResult::ended ? "it closed the connection" : error.text);
    return close_guest(server, guest);
  }
}

}  // namespace

void close_guest(Server* server, Guest* guest) {
  CHECK_GE(guest->stream, 0);
  server->net->close(server->link, guest->stream);
  guest->stream = -1;
}

bool drop_input(Server* server, int stream) {
  std::uint8_t bytes[512];
  std::size_t count = 0;
  platform::Error error;
  LinkResult result = server->net->read(server->link, stream, bytes, sizeof bytes, &count, &error);
  CHECK_LE(count, sizeof bytes);
  return result != LinkResult::ended && result != LinkResult::failed;
}

void tend_guest(Server* server, Guest* guest) {
  CHECK_GE(guest->stream, 0);
  if (!flush(server, guest)) return close_guest(server, guest);
  if (guest->leaves) {
    if (!drop_input(server, guest->stream)) return close_guest(server, guest);
  } else {
    read_hello(server, guest);
  }
  if (guest->stream < 0 || platform::link_timer_left(&guest->timer, now_ns(server)) > 0) return;
  if (!guest->leaves) log_guest(server, *guest, "it stopped in a message");
  close_guest(server, guest);
}

void accept_clients(Server* server) {
  server->accept_rests = false;
  for (int i = 0; i < kAcceptsAtOnce; ++i) {
    int stream = -1;
    platform::Error error;
    LinkResult result = server->net->accept(server->link, server->listener, &stream, &error);
    if (result == LinkResult::later) return;
    if (result == LinkResult::done) {
      receive_guest(server, stream);
      continue;
    }
    log_line(&server->log, now_ns(server), "a client could not be let in: %s", error.text);
    server->accept_rests = true;
    server->accept_timer = platform::link_timer(now_ns(server), kAcceptRestNs);
    return;
  }
}

}  // namespace pocketray
