// What a client learns by asking: how long an answer takes, and what a byte takes on the way. An answer with a payload
// means something where the device saw it come and no rows were on the same link: then the device looks often, and asks
// for rows a moment later.
#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kPings = 3;            // without a payload: the least of them is the round trip
constexpr std::uint32_t kPingsMissedMax = 24;  // after which answers that came unwatched have to do
constexpr double kUnwatchedInverse = 8,
                 kSizedUnwatchedInverse = 16;    // of an answer's time that the device may not have looked
constexpr double kSizingLookNs = 250e3;          // between two looks while an answer with a payload is timed
constexpr double kLongWorkNs = 100e6;            // and while there is none: servers and device are not to take each
                                                 // other for lost
constexpr std::uint64_t kQuietNs = 400'000'000;  // that others' rows may be held back while a link is measured,
constexpr std::uint64_t kAnewQuietNs = 200'000'000, kAnewNs = 3'000'000'000;  // and while it is again, this seldom
constexpr double kAnewAnswerNs = 100e6;            // that the answer then takes at most, as far as is known
constexpr double kScaledMax = 1.08;                // beyond which what follows from others is to be measured,
constexpr double kScaledAloneMax = 1.5;            // or from a single server's rows
constexpr std::uint32_t kPingBytesLeast = 1024;    // of the one that measures the bandwidth; twice as many each time,
constexpr std::uint32_t kPingBytesMost = 16384;    // until they take
constexpr double kPingTripsMin = 8;                // times as long as one without
constexpr std::uint64_t kPingWaitNs = 20'000'000;  // that the device waits for an answer and does nothing else,
constexpr std::uint64_t kSizedPingWaitNs = 200'000'000;  // and for one with a payload, over a slow link
constexpr double kNsPerByteMin = 1e-3;  // a link faster than a terabyte a second is one that was not measured

bool rows_are_under_way(const Client& c) {
  for (std::uint32_t i = 0; i < c.server_count; ++i)
    if (c.servers[i].frame.open && c.servers[i].phase != ServerPhase::waiting) return true;
  return false;
}

// The payload of the answer that is to be timed next. Servers may share the device's radio: one after the other.
std::uint32_t next_ping_bytes(const Client& c, const RemoteServer& s) {
  if (s.pings_answered < kPings) return 0;
  bool disturbed = c.options.has_scene && rows_are_under_way(c) && client_now_ns(c) < s.quiet_until_ns;
  if (disturbed) return 0;  // it comes when they are not
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    const RemoteServer& other = c.servers[i];
    if (&other != &s && other.phase == ServerPhase::measuring && other.ping_id != 0 && other.ping_bytes > 0) return 0;
  }
  std::uint32_t wanted = kPingBytesLeast << (s.pings_answered - kPings), room = s.messages.in.count - 64;
  return wanted < room ? wanted : room;
}

// Whether an answer was awaited when it came, so that its time means something.
bool is_watched(const Client& c, double ns, std::uint32_t byte_count) {
  double inverse = byte_count > 0 ? kSizedUnwatchedInverse : kUnwatchedInverse;
  return inverse * static_cast<double>(c.unwatched_ns) < ns;
}

// And one with a payload was alone on the link; a device without the scene does without that.
bool is_sound(const Client& c, const RemoteServer& s, double ns, std::uint32_t byte_count) {
  bool alone = s.ping_alone && !rows_are_under_way(c);
  return is_watched(c, ns, byte_count) && (alone || byte_count == 0 || !c.options.has_scene);
}

// What a byte takes by an answer of that time.
double ns_per_byte_of(const RemoteServer& s, double ns, std::uint32_t byte_count) {
  double per_byte = (ns - s.round_trip_ns) / byte_count;
  return per_byte > kNsPerByteMin ? per_byte : kNsPerByteMin;
}

// The overture's answers: first without a payload, then with as much as it takes to tell the link from its latency.
void take_measuring_pong(Client* c, RemoteServer* s, double ns, std::uint32_t byte_count) {
  bool sound = is_sound(*c, *s, ns, byte_count), waits = byte_count == 0 && s->pings_answered >= kPings;
  if (!waits && !sound && ++s->pings_missed < kPingsMissedMax) return send_ping(c, s, next_ping_bytes(*c, *s));
  if (!waits) ++s->pings_answered;
  if (byte_count == 0 && (s->round_trip_ns == 0 || ns < s->round_trip_ns)) s->round_trip_ns = ns;
  if (s->pings_answered == kPings && s->quiet_until_ns == 0) s->quiet_until_ns = client_now_ns(*c) + kQuietNs;
  bool tells = byte_count >= kPingBytesMost || ns >= kPingTripsMin * s->round_trip_ns;
  std::uint32_t next = next_ping_bytes(*c, *s);
  if (byte_count == 0 || (!tells && (next == 0 || next > byte_count))) return send_ping(c, s, next);
  s->ns_per_byte = ns_per_byte_of(*s, ns, byte_count);
  s->scaled = sound ? 1 : kUnsound;
  enter(c, s, ServerPhase::probing);
}

// The link of a server that is in use, measured anew. An answer that was seen late, or that rows held up, still says
// that the link is no slower.
void take_ready_pong(Client* c, RemoteServer* s, double ns, std::uint32_t byte_count) {
  s->quiet_until_ns = 0;
  ServerModel* model = &c->model.servers[index_of(*c, s)];
  double ns_per_byte = ns_per_byte_of(*s, ns, byte_count);
  bool sound = is_sound(*c, *s, ns, byte_count);
  if (!sound && !(ns_per_byte < static_cast<double>(model->ns_per_byte.value))) return;
  s->ns_per_byte = ns_per_byte;
  model->ns_per_byte = Smoothed();
  smooth(&model->ns_per_byte, ns_per_byte);
  observe_own_link(&c->model, ns_per_byte);
  s->scaled = sound ? 1 : kUnsound;
}

}  // namespace

void send_ping(Client* c, RemoteServer* s, std::uint32_t reply_bytes) {
  Message message;
  message.type = MessageType::ping;
  if (++s->ping_id == 0) ++s->ping_id;
  message.ping = {s->ping_id, reply_bytes};
  s->ping_bytes = reply_bytes;
  s->late_at_ping = s->late_rows;
  s->ping_alone = !rows_are_under_way(*c);
  s->ping_ns = client_now_ns(*c);
  send(c, s, message);
}

void take_pong(Client* c, RemoteServer* s, const Pong& pong) {
  // One ping is under way at most, so that there is no other to answer.
  if (s->ping_id == 0 || pong.id != s->ping_id || pong.bytes.count != s->ping_bytes) return lose_server(c, s, kUnasked);
  s->late_rows -= s->late_at_ping;  // they would have come before it
  s->late_at_ping = 0;
  double ns = static_cast<double>(client_now_ns(*c) - s->ping_ns);
  s->ping_id = 0;
  s->frame.answers = true;
  if (s->phase == ServerPhase::measuring) return take_measuring_pong(c, s, ns, pong.bytes.count);
  if (s->phase != ServerPhase::ready) return;
  if (pong.bytes.count > 0) return take_ready_pong(c, s, ns, pong.bytes.count);
  const Smoothed& start = c->model.servers[index_of(*c, s)].start_ns;
  if (is_watched(*c, ns, 0) || ns < static_cast<double>(start.value)) observe_start(&c->model, index_of(*c, s), ns);
  if (pong.pixel_ps > 0) observe_server_price(&c->model, index_of(*c, s), 1e-3 * pong.pixel_ps);
}

bool wants_quiet(const Client& c) {
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    const RemoteServer& s = c.servers[i];
    bool sizes = s.phase == ServerPhase::measuring
                     ? s.pings_answered >= kPings
                     : s.phase == ServerPhase::ready && s.ping_id != 0 && s.ping_bytes > 0;
    if (sizes && client_now_ns(c) < s.quiet_until_ns) return true;
  }
  return false;
}

void measure_anew(Client* c) {
  if (!c->options.has_scene || wants_quiet(*c)) return;
  std::uint64_t now = client_now_ns(*c);
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    double scaled_max = c->server_count == 1 ? kScaledAloneMax : kScaledMax;
    bool doubtful = s->scaled > scaled_max || s->scaled * scaled_max < 1;
    if (s->phase != ServerPhase::ready || s->ping_id != 0 || now < s->anew_ns || !doubtful) continue;
    double bytes = kAnewAnswerNs / s->ns_per_byte, least = kPingBytesLeast, most = kPingBytesMost;
    s->anew_ns = now + kAnewNs;
    s->quiet_until_ns = now + kAnewQuietNs;
    send_ping(c, s, static_cast<std::uint32_t>(bytes < least ? least : bytes > most ? most : bytes));
    return flush_server(c, s);  // one after the other
  }
}

double work_ns_max(const Client& c) {
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    const RemoteServer& s = c.servers[i];
    if (s.phase != ServerPhase::waiting && s.ping_id != 0 && s.ping_bytes > 0) return kSizingLookNs;
  }
  return kLongWorkNs;
}

std::uint64_t wait_wanted_ns(const Client& c) {
  std::uint64_t wanted = 0;
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    const RemoteServer& s = c.servers[i];
    bool is_measured = s.phase == ServerPhase::measuring || (s.phase == ServerPhase::ready && s.ping_bytes > 0);
    if (is_measured && s.ping_id != 0) {
      std::uint64_t since = client_now_ns(c) - s.ping_ns, wait = s.ping_bytes > 0 ? kSizedPingWaitNs : kPingWaitNs;
      if (since < wait && wait - since > wanted) wanted = wait - since;
    }
  }
  return wanted;
}

}  // namespace pocketray
