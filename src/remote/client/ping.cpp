// Measures links by pings: round trip and time per byte. An answer with a payload counts only if the device polled when
// it came and no rows were on the link; so the device then polls often and requests rows a moment later.
#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Measured together, by `make split-table` (a wrongly measured link shows as a split far from the best one) and `make
// faults` (frames while measuring stay within 1.05 of the device alone). Waits are shorter than a display frame, or
// than the time until a peer counts as lost, silence_timeout_ns.
constexpr std::uint32_t kPings = 3;            // without a payload; the fastest is the round trip
constexpr std::uint32_t kPingsMissedMax = 24;  // after which unwatched answers must do
constexpr double kUnwatchedInverse = 8,
                 kSizedUnwatchedInverse = 16;  // inverse fraction of an answer's time without polls
constexpr double kSizingLookNs = 250e3;        // between polls while an answer with a payload is timed
constexpr double kLongWorkNs = 100e6;          // otherwise, so that neither servers nor device consider the other lost
constexpr double kCoarseLookNs = 4e6;          // chosen: while a coarse picture is due, a quarter of a display frame
constexpr std::uint64_t kQuietNs = 400'000'000;  // longest hold on others' rows while a link is measured,
constexpr std::uint64_t kAnewQuietNs = 200'000'000,
                        kAnewNs = 3'000'000'000;         // and while it is measured again, at this interval
constexpr double kAnewAnswerNs = 100e6;                  // longest expected answer of a repeated measurement
constexpr double kScaledMax = 1.08;                      // link is measured again if others' rows scale it beyond this,
constexpr double kScaledAloneMax = 1.5;                  // or a single server's rows beyond this
constexpr std::uint32_t kPingBytesLeast = 1024;          // payload to measure the bandwidth; doubles each time
constexpr std::uint32_t kPingBytesMost = 16384;          // up to this, or until the answer
constexpr double kPingTripsMin = 8;                      // takes this many times one without payload
constexpr std::uint64_t kPingWaitNs = 20'000'000;        // longest idle wait for an answer,
constexpr std::uint64_t kSizedPingWaitNs = 200'000'000;  // and for one with a payload, over a slow link
constexpr double kNsPerByteMin = 1e-3;                   // a link faster than a terabyte per second was not measured

bool rows_are_under_way(const Client& client) {
  for (std::uint32_t i = 0; i < client.server_count; ++i)
    if (client.servers[i].rows.frame.open && client.servers[i].overture.phase != ServerPhase::waiting) return true;
  return false;
}

// Payload of the next answer to time. Servers may share the device's radio, so one is measured at a time.
std::uint32_t next_ping_bytes(const Client& client, const RemoteServer& server) {
  if (server.link.pings_answered < kPings) return 0;
  bool disturbed =
      client.options.has_scene && rows_are_under_way(client) && client_now_ns(client) < server.link.quiet_until_ns;
  if (disturbed) return 0;  // wait until they have come
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& other = client.servers[i];
    if (&other != &server && other.overture.phase == ServerPhase::measuring && other.link.ping_id != 0 &&
        other.link.ping_bytes > 0)
      return 0;
  }
  CHECK_LE(server.link.pings_answered - kPings, 8u);  // the payload doubles until an answer tells
  std::uint32_t wanted = kPingBytesLeast << (server.link.pings_answered - kPings), room = server.messages.in.count - 64;
  return wanted < room ? wanted : room;
}

// True if the device polled often enough when the answer came to time it.
bool is_watched(const Client& client, double ns, std::uint32_t byte_count) {
  double inverse = byte_count > 0 ? kSizedUnwatchedInverse : kUnwatchedInverse;
  return inverse * static_cast<double>(client.unwatched_ns) < ns;
}

// True if, in addition, an answer with a payload was alone on the link; not required without the scene.
bool is_sound(const Client& client, const RemoteServer& server, double ns, std::uint32_t byte_count) {
  bool alone = server.link.ping_alone && !rows_are_under_way(client);
  return is_watched(client, ns, byte_count) && (alone || byte_count == 0 || !client.options.has_scene);
}

// Derives the time per byte from the time of an answer.
double ns_per_byte_of(const RemoteServer& server, double ns, std::uint32_t byte_count) {
  CHECK_GT(byte_count, 0u);
  double per_byte = (ns - server.link.round_trip_ns) / byte_count;
  return per_byte > kNsPerByteMin ? per_byte : kNsPerByteMin;
}

// Takes answers of the overture: first without a payload, then with enough to tell bandwidth from latency.
void take_measuring_pong(Client* client, RemoteServer* server, double ns, std::uint32_t byte_count) {
  bool sound = is_sound(*client, *server, ns, byte_count),
       waits = byte_count == 0 && server->link.pings_answered >= kPings;
  if (!waits && !sound && ++server->link.pings_missed < kPingsMissedMax)
    return send_ping(client, server, next_ping_bytes(*client, *server));
  if (!waits) ++server->link.pings_answered;
  if (byte_count == 0 && (server->link.round_trip_ns == 0 || ns < server->link.round_trip_ns))
    server->link.round_trip_ns = ns;
  if (server->link.pings_answered == kPings && server->link.quiet_until_ns == 0)
    server->link.quiet_until_ns = client_now_ns(*client) + kQuietNs;
  bool tells = byte_count >= kPingBytesMost || ns >= kPingTripsMin * server->link.round_trip_ns;
  std::uint32_t next = next_ping_bytes(*client, *server);
  if (byte_count == 0 || (!tells && (next == 0 || next > byte_count))) return send_ping(client, server, next);
  server->link.ns_per_byte = ns_per_byte_of(*server, ns, byte_count);
  server->link.scaled = sound ? 1 : kUnsound;
  enter(client, server, ServerPhase::probing);
}

// Measures the link of a server in use again. An answer that was seen late, delayed by rows, or at most twice as late
// as one without a payload, whose time may have been too long, still bounds the link from below.
void take_ready_pong(Client* client, RemoteServer* server, double ns, std::uint32_t byte_count) {
  server->link.quiet_until_ns = 0;
  ServerModel* model = &client->plan.model.servers[index_of(*client, server)];
  const bool sound = is_sound(*client, *server, ns, byte_count) && ns > 2 * server->link.round_trip_ns;
  const double ns_per_byte = sound ? ns_per_byte_of(*server, ns, byte_count) : ns / byte_count;
  if (!sound && !(ns_per_byte < static_cast<double>(model->ns_per_byte.value))) return;
  server->link.ns_per_byte = ns_per_byte;
  model->ns_per_byte = Smoothed();
  smooth(&model->ns_per_byte, ns_per_byte);
  observe_own_link(&client->plan.model, ns_per_byte);
  server->link.scaled = sound ? 1 : kUnsound;
}

}  // namespace

void send_ping(Client* client, RemoteServer* server, std::uint32_t reply_bytes) {
  CHECK_LE(reply_bytes, kPingBytesMax);
  Message message;
  message.type = MessageType::ping;
  if (++server->link.ping_id == 0) ++server->link.ping_id;
  message.ping = {server->link.ping_id, reply_bytes};
  server->link.ping_bytes = reply_bytes;
  server->link.late_at_ping = server->rows.late_rows;
  server->link.ping_alone = !rows_are_under_way(*client);
  server->link.ping_ns = client_now_ns(*client);
  send(client, server, message);
}

void take_pong(Client* client, RemoteServer* server, const Pong& pong) {
  // At most one ping is in flight, so no other can be answered.
  if (server->link.ping_id == 0 || pong.id != server->link.ping_id || pong.bytes.count != server->link.ping_bytes)
    return lose_server(client, server, kUnasked);
  CHECK_LE(server->link.late_at_ping, server->rows.late_rows);
  server->rows.late_rows -= server->link.late_at_ping;  // they would have arrived before it
  server->link.late_at_ping = 0;
  double ns = static_cast<double>(client_now_ns(*client) - server->link.ping_ns);
  server->link.ping_id = 0;
  server->rows.frame.answers = true;
  observe_price(&client->plan.model, index_of(*client, server), price_ratio(pong.price));
  server->rows.price = pong.price;
  if (server->overture.phase == ServerPhase::measuring)
    return take_measuring_pong(client, server, ns, pong.bytes.count);
  if (server->overture.phase != ServerPhase::ready) return;
  if (pong.bytes.count > 0) return take_ready_pong(client, server, ns, pong.bytes.count);
  const Smoothed& start = client->plan.model.servers[index_of(*client, server)].start_ns;
  if (is_watched(*client, ns, 0) || ns < static_cast<double>(start.value))
    observe_start(&client->plan.model, index_of(*client, server), ns);
  if (pong.pixel_ps > 0) observe_server_speed(&client->plan.model, index_of(*client, server), 1e-3 * pong.pixel_ps);
}

bool wants_quiet(const Client& client) {
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    bool sizes =
        server.overture.phase == ServerPhase::measuring
            ? server.link.pings_answered >= kPings
            : server.overture.phase == ServerPhase::ready && server.link.ping_id != 0 && server.link.ping_bytes > 0;
    if (sizes && client_now_ns(client) < server.link.quiet_until_ns) return true;
  }
  return false;
}

void measure_anew(Client* client) {
  if (!client->options.has_scene || wants_quiet(*client)) return;
  std::uint64_t now = client_now_ns(*client);
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    double scaled_max = client->server_count == 1 ? kScaledAloneMax : kScaledMax;
    bool doubtful = server->link.scaled > scaled_max || server->link.scaled * scaled_max < 1;
    if (server->overture.phase != ServerPhase::ready || server->link.ping_id != 0 || now < server->link.anew_ns ||
        !doubtful)
      continue;
    double bytes = kAnewAnswerNs / server->link.ns_per_byte, least = kPingBytesLeast, most = kPingBytesMost;
    server->link.anew_ns = now + kAnewNs;
    server->link.quiet_until_ns = now + kAnewQuietNs;
    send_ping(client, server, static_cast<std::uint32_t>(bytes < least ? least : bytes > most ? most : bytes));
    return flush_server(client, server);  // one at a time
  }
}

double work_ns_max(const Client& client) {
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    if (server.overture.phase != ServerPhase::waiting && server.link.ping_id != 0 && server.link.ping_bytes > 0)
      return kSizingLookNs;
  }
  return awaits_coarse(client) ? kCoarseLookNs : kLongWorkNs;
}

std::uint64_t wait_wanted_ns(const Client& client) {
  std::uint64_t wanted = 0;
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    bool is_measured = server.overture.phase == ServerPhase::measuring ||
                       (server.overture.phase == ServerPhase::ready && server.link.ping_bytes > 0);
    if (is_measured && server.link.ping_id != 0) {
      std::uint64_t since = client_now_ns(client) - server.link.ping_ns,
                    wait = server.link.ping_bytes > 0 ? kSizedPingWaitNs : kPingWaitNs;
      if (since < wait && wait - since > wanted) wanted = wait - since;
    }
  }
  return wanted;
}

}  // namespace pocketray
