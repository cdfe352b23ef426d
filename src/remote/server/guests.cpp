// Admission: connections become guests, and guests that say hello get a place.
#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "remote/server/state.h"

namespace pocketray {
namespace {

using platform::LinkResult;

// Chosen: a few round trips of a slow link; a pause that keeps floods from filling the log.
constexpr std::uint64_t kLingerNs = 2'000'000'000;  // for a leaving peer to read the reason
constexpr std::uint64_t kAcceptRestNs =
    1'000'000'000;  // pause after a failed accept, since the scarce resource will not be free at once
// After guests were tended, they rest for this many times the time taken, but at most a slice, while sessions have
// work. Chosen: a flood of connections takes about an eighth of the time.
constexpr std::uint64_t kGuestRestFactor = 7;

void queue(Guest* guest, const Message& message) { CHECK(send_message(&guest->messages, message)); }

// Sends as much as there is room for; returns false if the connection is lost.
bool flush(Guest* guest) {
  platform::Error error;
  return flush_message_stream(&guest->messages, &error);
}

// Most guests of one address: however many it sends and however long their handshakes take, others find room.
int guests_max(const Server& server) { return std::max(1, server.options.guest_count_max / 2); }

void send_away(Server* server, Guest* guest, WireError code) {
  CHECK(!guest->leaves);
  Message message;
  message.type = MessageType::error;
  message.error.code = code;
  queue(guest, message);
  guest->leaves = true;
  guest->timer = platform::link_timer(now_ns(server), kLingerNs);
  if (!flush(guest)) close_guest(guest);
}

int guests_of(const Server& server, std::uint64_t key) {
  return static_cast<int>(std::count_if(server.guests.begin(), server.guests.end(),
                                        [&](const Guest& g) { return is_open(g) && g.key == key; }));
}

// Returns a free slot for a guest of that address, else that of the longest-waiting guest among those leaving or,
// failing that, of the address with most guests; of its own address if that has its share.
Guest* free_guest(Server* server, std::uint64_t key) {
  const bool own = guests_of(*server, key) >= guests_max(*server);
  Guest* chosen = nullptr;
  int most = 0;
  std::uint64_t least = 0;
  for (Guest& guest : server->guests) {
    if (!is_open(guest) && !own) return &guest;
    if (!is_open(guest) || (own && guest.key != key)) continue;
    int count = guest.leaves ? kAddressCountMax : guests_of(*server, guest.key);
    std::uint64_t left = platform::link_timer_left(&guest.timer, now_ns(server));
    if (count < most || (count == most && left >= least)) continue;
    chosen = &guest, most = count, least = left;
  }
  CHECK(chosen != nullptr);  // there is room for at least one
  close_guest(chosen);
  return chosen;
}

void receive_guest(Server* server, int stream) {
  CHECK_GE(stream, 0);
  const std::uint64_t key = address_key(server->net->stream_name(server->link, stream));
  Guest* guest = free_guest(server, key);
  *guest = Guest();
  guest->messages.in = {guest->input, sizeof guest->input};
  guest->messages.out = {guest->output, sizeof guest->output};
  start_message_stream(&guest->messages, server->link, stream);
  guest->key = key;
  guest->timer = platform::link_timer(now_ns(server), server->options.message_timeout_ns);
  queue(guest, server_hello(*server, key));
  if (!flush(guest)) close_guest(guest);
}

// Returns the least recently seen address without sessions, preferably one that has not been sent light frames: clients
// that keep coming from new addresses make the server forget only those.
int forgotten_address(const Server& server) {
  const std::vector<Address>& all = server.addresses;
  int oldest = -1;
  auto goes_before = [&](const Address& a, const Address& b) {
    const bool proven[2] = {is_proven(a.account), is_proven(b.account)};
    return proven[0] != proven[1] ? proven[1] : a.last_ns < b.last_ns;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    bool taken = std::any_of(server.sessions.begin(), server.sessions.end(), [&](const Session& session) {
      return session.phase != SessionPhase::unused && session.address == static_cast<int>(i);
    });
    if (!taken && (oldest < 0 || goes_before(all[i], all[static_cast<std::size_t>(oldest)])))
      oldest = static_cast<int>(i);
  }
  CHECK_GE(oldest, 0);  // there are more addresses than sessions
  return oldest;
}

// Finds or creates the account of an address, reusing another if necessary.
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

const char* name_of(const Server& server, const Guest& guest) {
  return server.net->stream_name(server.link, guest.messages.stream);
}

// Moves a connection to another stream, with its pending input and output.
void hand_over(MessageStream* from, MessageStream* to) {
  std::size_t received = input_bytes(*from), queued = queued_bytes(*from);
  CHECK_LE(received, to->in.count);
  std::memcpy(to->in.data, from->in.data + from->in_begin, received);
  to->in_end = received;
  std::memcpy(reserve_output(to, queued), from->out.data + from->out_begin, queued);
  to->out_end += queued;
  to->ended = from->ended;
  from->stream = -1;
}

// Gives the guest a place.
void seat(Server* server, Guest* guest, const Hello& hello) {
  int address = find_address(server, guest->key);
  Session* session = find_place(server, address);
  if (!session) {
    log_line(&server->log, now_ns(server), "%s was turned away: all %zu places are taken", name_of(*server, *guest),
             server->sessions.size());
    return send_away(server, guest, WireError::busy);
  }
  restart_session(session, server->link, guest->messages.stream);
  session->phase = SessionPhase::serving;
  session->address = address;
  Account* of_address = &server->addresses[static_cast<std::size_t>(address)].account;
  session->account.seat = ++server->seat_count;
  if (places_of(*server, address) == 1) of_address->seat = session->account.seat;
  session->price = newcomer_price(*server, guest->key);
  session->message_bytes_max = hello.message_bytes_max;
  std::snprintf(session->name, sizeof session->name, "%s", name_of(*server, *guest));
  std::uint64_t now = now_ns(server);
  server->addresses[static_cast<std::size_t>(address)].last_ns = session->seated_ns = now;
  session->message_timer = platform::link_timer(now, server->options.message_timeout_ns);
  session->idle_timer = platform::link_timer(now, server->options.idle_timeout_ns);
  session->stall_timer = platform::link_timer(now, server->options.stall_timeout_ns);
  hand_over(&guest->messages, &session->messages);
  session->more_to_take = true;
  ++server->totals.client_count;
  log_line(&server->log, now, "%s connected", session->name);
}

void log_guest(Server* server, const Guest& guest, const char* reason) {
  log_line(&server->log, now_ns(server), "%s disconnected: %s", name_of(*server, guest), reason);
}

// Reads the first message; the bytes after it belong to the session.
void read_hello(Server* server, Guest* guest) {
  platform::Error error;
  bool open = read_message_stream(&guest->messages, &error);
  Message message;
  DecodeState state = take_message(&guest->messages, &message);
  if (state == DecodeState::message && message.type == MessageType::hello) {
    if (message.hello.version == kWireVersion) return seat(server, guest, message.hello);
    log_guest(server, *guest, "it speaks a different protocol version");
    return send_away(server, guest, WireError::wrong_version);
  }
  if (state != DecodeState::need_more) {
    log_guest(server, *guest, "it did not begin with a hello");
    return send_away(server, guest, WireError::malformed);
  }
  if (open && !guest->messages.ended) return;
  log_guest(server, *guest, open ? "it closed the connection" : error.text);
  close_guest(guest);
}

}  // namespace

void close_guest(Guest* guest) {
  CHECK(is_open(*guest));
  close_message_stream(&guest->messages);
}

bool discard_input(MessageStream* messages) {
  platform::Error error;
  drop_input(messages);
  bool open = read_message_stream(messages, &error) && !messages->ended;
  drop_input(messages);
  return open;
}

namespace {

// Reads a guest's input: with a hello, it gets a place or is told that there is none.
void tend_guest(Server* server, Guest* guest) {
  CHECK(is_open(*guest));
  platform::Error error;
  if (!flush_message_stream(&guest->messages, &error)) {
    if (!guest->leaves) log_guest(server, *guest, error.text);
    return close_guest(guest);
  }
  if (guest->leaves) {
    if (!discard_input(&guest->messages)) return close_guest(guest);
  } else {
    read_hello(server, guest);
  }
  if (!is_open(*guest) || platform::link_timer_left(&guest->timer, now_ns(server)) > 0) return;
  if (!guest->leaves) log_guest(server, *guest, "it stopped in the middle of a message");
  close_guest(guest);
}

// Accepts the connections waiting at the listener.
void accept_clients(Server* server) {
  server->accept_rests = false;
  // More connections from one address would only displace each other.
  for (int i = 0; i < guests_max(*server); ++i) {
    int stream = -1;
    platform::Error error;
    LinkResult result = server->net->accept(server->link, server->listener, &stream, &error);
    if (result == LinkResult::later) return;
    if (result == LinkResult::done) {
      receive_guest(server, stream);
      continue;
    }
    log_line(&server->log, now_ns(server), "could not accept a client: %s", error.text);
    server->accept_rests = true;
    server->accept_timer = platform::link_timer(now_ns(server), kAcceptRestNs);
    return;
  }
}

}  // namespace

void tend_guests(Server* server, bool comes) {
  if (!comes && std::none_of(server->guests.begin(), server->guests.end(), is_open)) return;
  const std::uint64_t start = cpu_now_ns(server);
  if (platform::link_timer_left(&server->guest_rest, now_ns(server)) > 0 && work_due_ns(server) == 0) return;
  if (comes) accept_clients(server);
  for (Guest& guest : server->guests)
    if (is_open(guest)) tend_guest(server, &guest);
  const std::uint64_t now = cpu_now_ns(server), took = now > start ? now - start : 0;
  server->guest_rest = platform::link_timer(now_ns(server), std::min(kGuestRestFactor * took, kSliceNs));
}

}  // namespace pocketray
