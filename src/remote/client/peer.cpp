// One server as seen by the device: connection, overture, rows, failures.
#include <cinttypes>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Chosen: rarely enough to cost nothing, often enough that a server returns within a second. `make faults` tests that a
// flapping server is retried ever less often.
constexpr std::uint64_t kIdlePingNs = 500'000'000;  // between pings of a server that is asked for nothing
// A connection that was useful for this many times the wait before it was sound, so the next attempt comes soon.
constexpr std::uint64_t kLastingWaits = 10;
// Limit per server and poll, besides a picture's number of rows. Derived: about twice the messages of 240 rows in the
// smallest chunks (kChunkRowsMin).
constexpr std::uint32_t kLookMessages = 256;
void tell(Client* client, const char* format, ...) __attribute__((format(printf, 2, 3)));
void tell(Client* client, const char* format, ...) {
  if (!client->options.log) return;
  char line[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  client->options.log(client->options.log_context, line);
}

void connect_server(Client* client, RemoteServer* server) {
  CHECK(server->overture.phase == ServerPhase::waiting);
  platform::Error error;
  if (!connect_message_stream(&server->messages, client->link, server->address, client->options.connect_timeout_ns,
                              &error))
    return lose_server(client, server, error.text);
  enter(client, server, ServerPhase::connecting);
}

void greet_server(Client* client, RemoteServer* server) {
  CHECK(server->overture.phase == ServerPhase::connecting);
  restart_row_decoder(server->decoder);
  server->rows.coarse_due = server->light.due = 0, server->light.asked_ns = 0;
  server->link.pings_answered = server->link.pings_missed = 0, server->link.ping_id = 0, server->link.round_trip_ns = 0;
  server->rows.chunk_count = 0, server->rows.unanswered = false;
  server->link.quiet_until_ns = server->link.anew_ns = 0;
  server->rows.asked = FrameRequest();
  server->rows.due = RowSequence(), server->rows.due_rows = 0, server->rows.late_rows = server->link.late_at_ping = 0;
  server->rows.frame = ServerFrame();
  enter(client, server, ServerPhase::greeting);
  Message message;
  message.type = MessageType::hello;
  message.hello.image_side_max = static_cast<std::uint16_t>(kImageSideMax);
  message.hello.message_bytes_max = server->messages.in.count;
  send(client, server, message);
}

void take_hello(Client* client, RemoteServer* server, const Hello& hello) {
  Status same_version = check_version(hello);
  if (!same_version.ok) return lose_server(client, server, same_version.message);
  if (client->settings.width > hello.image_side_max || client->settings.height > hello.image_side_max)
    return lose_server(client, server, "it does not render pictures of that size: use a smaller --size");
  observe_price(&client->plan.model, index_of(*client, server), price_ratio(hello.price));
  server->rows.price = hello.price;
  enter(client, server, ServerPhase::asking);
  Message message;
  message.type = MessageType::scene_query;
  message.scene_query.hash = client->scene;
  send(client, server, message);
}

void take_scene_entry(Client* client, RemoteServer* server, const SceneEntry& entry) {
  if (entry.byte_count == 0)
    return lose_server(client, server,
                       "it does not have this scene: put the same file into the folder it serves (--scenes)");
  if (entry.hash != client->scene) return lose_server(client, server, kUnasked);
  enter(client, server, ServerPhase::measuring);
  send_ping(client, server, 0);
}

// True if these are the next rows of the last request.
bool is_next(const RemoteServer& server, const RowChunk& chunk) {
  const std::uint32_t end = std::uint32_t(chunk.row_begin) + chunk.row_count;
  return chunk.frame == server.rows.asked.frame && end == server.rows.due.row_end &&
         chunk.row_begin >= server.rows.due.row_begin && chunk.row_count <= server.rows.due_rows;
}

// Returns whether the server owes these rows: the next of the last request, in its order, or rows in flight when that
// replaced an earlier request. No row is owed twice, which bounds what a server can make the device decode. A chunk of
// the last request ends the earlier ones.
bool takes_owed_rows(RemoteServer* server, const RowChunk& chunk) {
  if (is_next(*server, chunk)) {
    pass_rows(server->rows.asked, chunk.row_count, &server->rows.due);
    server->rows.due_rows -= chunk.row_count;
    server->rows.late_rows = server->link.late_at_ping = 0;
    server->rows.coarse_due = 0;  // it would have come before
    server->light.due = 0;
    return true;
  }
  if (chunk.row_count > server->rows.late_rows) return false;
  server->rows.late_rows -= chunk.row_count;
  server->link.late_at_ping -=
      server->link.late_at_ping < chunk.row_count ? server->link.late_at_ping : chunk.row_count;
  return true;
}

void learn_decoding(Client* client, std::uint64_t pixel_count, std::uint32_t code_bytes, std::uint64_t ns) {
  const double pixels = static_cast<double>(pixel_count);
  smooth(&client->plan.decode_ns, static_cast<double>(ns) / pixels);
  smooth(&client->plan.code_saves, pixel_bytes(client->options.format) - code_bytes / pixels);
}

void take_chunk(Client* client, RemoteServer* server, RowChunk chunk) {
  chunk.frame = frame_of(chunk.frame, server->rows.asked.frame);
  const bool states_price = chunk.price != 0;
  if (!states_price) chunk.price = server->rows.price;
  server->rows.price = chunk.price;
  if (awaits_light(*server) && is_next(*server, chunk))
    return lose_server(client, server, "it sent rows without their light");
  if (!takes_owed_rows(server, chunk)) return lose_server(client, server, "it sent unrequested rows");
  if (chunk.bytes.count > encoded_bytes_max(server->decoder->state.shape, chunk.row_count))
    return lose_server(client, server, "it sent more bytes than its rows can take");
  // Rows decoded twice or out of order would corrupt the decoder's picture.
  if (!take_chunk_number(&chunk, server->rows.chunk_count++))
    return lose_server(client, server, "it sent rows out of order");
  std::uint64_t begin_ns = client_now_ns(*client);
  if (!decode_rows(server->decoder, chunk)) return lose_server(client, server, "it sent rows that cannot be decoded");
  std::uint64_t unpacked_ns = client_now_ns(*client) - begin_ns;
  const std::uint64_t pixel_count = std::uint64_t(chunk.row_count) * client->settings.width;
  const bool coded = chunk.encoding == kEncodingCoded;
  if (client->options.decode.pixel_ns > 0) {
    unpacked_ns = code_ns(client->options.decode, pixel_count, coded ? chunk.bytes.count : 0);
    work_until(client, begin_ns + unpacked_ns);
  }
  if (coded && chunk.traced > 0) learn_decoding(client, pixel_count, chunk.bytes.count, unpacked_ns);
  std::uint32_t bytes = row_chunk_prefix_bytes(states_price, chunk.prepare_ns != 0) + chunk.bytes.count;
  observe_unpack(&client->plan.model, bytes, static_cast<double>(unpacked_ns));
  accept_chunk(client, server, chunk, bytes);
}

// Like rows, it may belong to an earlier request.
void take_coarse(Client* client, RemoteServer* server, CoarsePicture coarse) {
  if (server->rows.coarse_due == 0) return lose_server(client, server, kUnasked);
  coarse.frame = frame_of(coarse.frame, server->rows.asked.frame);
  server->rows.coarse_due = coarse.frame == server->rows.asked.frame ? 0 : server->rows.coarse_due - 1;
  if (coarse.pixels.count != coarse_bytes(client->settings.width, client->settings.height, client->options.format))
    return lose_server(client, server, "it sent a coarse picture of the wrong size");
  server->rows.frame.bytes += coarse_prefix_bytes() + coarse.pixels.count;
  if (coarse.frame == client->frame.request.frame && !client->frame.complete) show_coarse(client, coarse);
}

void take(Client* client, RemoteServer* server, const Message& message) {
  bool greeted = server->overture.phase != ServerPhase::greeting;
  if (message.type == MessageType::hello && !greeted) return take_hello(client, server, message.hello);
  if (message.type == MessageType::scene_entry && server->overture.phase == ServerPhase::asking)
    return take_scene_entry(client, server, message.scene_entry);
  if (message.type == MessageType::pong && greeted) return take_pong(client, server, message.pong);
  if (message.type == MessageType::row_chunk && server->overture.phase >= ServerPhase::probing)
    return take_chunk(client, server, message.row_chunk);
  if (message.type == MessageType::coarse_picture && server->overture.phase >= ServerPhase::probing)
    return take_coarse(client, server, message.coarse_picture);
  if (message.type == MessageType::light_map && server->overture.phase >= ServerPhase::probing)
    return take_light(client, server, message.light_map);
  if (message.type == MessageType::error) return lose_server(client, server, wire_error_text(message.error.code));
  lose_server(client, server, kUnasked);
}

// True if an answer or rows are due.
bool is_awaited(const Client& client, const RemoteServer& server) {
  if (server.overture.phase == ServerPhase::ready || server.overture.phase == ServerPhase::probing)
    return server.rows.frame.open || server.light.due > 0 || server.link.ping_id != 0 || server.rows.unanswered;
  (void)client;
  return server.overture.phase != ServerPhase::waiting;
}

// Returns whether light has been overdue for long enough to give up the server, however well it answers pings. If the
// device has not polled for long, for example because it slept, the server gets half of the time again.
bool is_light_overdue(Client* client, RemoteServer* server) {
  const std::uint64_t limit = client->options.prepare_timeout_ns, now = client_now_ns(*client);
  if (server->light.asked_ns == 0 || now - server->light.asked_ns < limit || server->rows.more) return false;
  if (client->unwatched_ns < limit / 2) return true;
  server->light.asked_ns = now - limit / 2;
  return false;
}

// Reads at most a frame's worth, so that no server can stall the device.
void read_server(Client* client, RemoteServer* server) {
  platform::Error error;
  std::uint32_t messages = 0, rows = 0;
  server->rows.more = false;
  for (;;) {
    if (!pump_message_stream(&server->messages, &error)) return lose_server(client, server, error.text);
    bool took = false;
    for (;;) {
      server->rows.more = messages == kLookMessages || rows >= client->settings.height;
      if (server->rows.more) return;
      Message message;
      DecodeState state = take_message(&server->messages, &message);
      if (state == DecodeState::malformed) return lose_server(client, server, malformed_text(server->messages));
      if (state == DecodeState::need_more) break;
      took = true;
      ++messages;
      if (message.type == MessageType::row_chunk) rows += message.row_chunk.row_count;
      server->rows.unanswered = false;
      server->overture.timer = platform::link_timer(client_now_ns(*client), silence_limit_ns(*client, *server));
      take(client, server, message);
      if (server->overture.phase == ServerPhase::waiting) return;
    }
    if (!took) return;
  }
}

}  // namespace

void enter(Client* client, RemoteServer* server, ServerPhase phase) {
  server->overture.phase = phase;
  server->overture.phase_ns = client_now_ns(*client);
  server->overture.timer = platform::link_timer(client_now_ns(*client), silence_limit_ns(*client, *server));
}

void send(Client* client, RemoteServer* server, const Message& message) {
  if (!send_message(&server->messages, message)) lose_server(client, server, "it stopped reading");
}

const char* wire_error_text(WireError code) {
  switch (code) {
    case WireError::wrong_version:
      return "it speaks a different protocol version: update one of the two";
    case WireError::malformed:
      return "it could not decode a message";
    case WireError::unknown_scene:
      return "it does not have this scene: put the same file into the folder it serves (--scenes)";
    case WireError::too_large:
      return "the picture is too large for it: use a smaller --size, or serve with more --memory";
    case WireError::bad_request:
      return "it cannot render with these settings, or the scene lacks the animation or camera asked for";
    case WireError::busy:
      return "it is full: serve with more --clients";
    case WireError::closing:
      return "it was shut down";
  }
  return "it reported an error";
}

const char* phase_text(ServerPhase phase) {
  switch (phase) {
    case ServerPhase::waiting:
      return "unreachable";
    case ServerPhase::connecting:
      return "connecting";
    case ServerPhase::greeting:
    case ServerPhase::asking:
    case ServerPhase::measuring:
    case ServerPhase::probing:
      return "measuring";
    case ServerPhase::ready:
      break;
  }
  return "ready";
}

std::uint64_t silence_limit_ns(const Client& client, const RemoteServer& server) {
  const ClientOptions& o = client.options;
  if (server.overture.phase == ServerPhase::connecting) return o.connect_timeout_ns;
  return server.overture.phase == ServerPhase::probing ? o.prepare_timeout_ns : o.silence_timeout_ns;
}

void lose_server(Client* client, RemoteServer* server, const char* reason) {
  CHECK(reason != nullptr);
  close_message_stream(&server->messages);
  server->rows.more = false;
  std::uint32_t i = index_of(*client, server);
  client->plan.model.servers[i].connected = false;
  server->rows.frame.open = false;
  if (server->light.asked_ns > 0) ++server->light.missed;
  server->light.asked_ns = 0;
  forget_light_of(client, i);
  server->overture.phase = ServerPhase::waiting;
  std::uint64_t now = client_now_ns(*client);
  if (server->overture.useful_ns > 0 && now - server->overture.useful_ns >= kLastingWaits * server->overture.retry_ns)
    server->overture.retry_ns = 0;
  server->overture.useful_ns = 0;
  std::uint64_t next = 2 * server->overture.retry_ns;
  server->overture.retry_ns = next < client->options.retry_ns_min   ? client->options.retry_ns_min
                              : next > client->options.retry_ns_max ? client->options.retry_ns_max
                                                                    : next;
  server->overture.timer = platform::link_timer(now, server->overture.retry_ns);
  if (!server->overture.told)
    tell(client, "server %s: %s; continuing without it and retrying", server->address.text, reason);
  server->overture.told = true;
}

void flush_server(Client* client, RemoteServer* server) {
  platform::Error error;
  if (server->overture.phase != ServerPhase::waiting && !flush_message_stream(&server->messages, &error))
    lose_server(client, server, error.text);
}

void server_is_ready(Client* client, RemoteServer* server) {
  CHECK(server->overture.phase == ServerPhase::probing);
  server->overture.phase = ServerPhase::ready;
  server->link.ping_due_ns = client_now_ns(*client) + kIdlePingNs;
  client->plan.model.servers[index_of(*client, server)].connected = true;
  if (server->overture.useful_ns > 0) server_is_useful(client, server);
}

void server_is_useful(Client* client, RemoteServer* server) {
  if (server->overture.useful_ns == 0) server->overture.useful_ns = client_now_ns(*client);
  if (server->overture.phase != ServerPhase::ready) return;
  if (server->overture.told) tell(client, "server %s is in use again", server->address.text);
  server->overture.told = false;
}

void advance_server(Client* client, RemoteServer* server) {
  if (server->overture.lied) return;
  std::uint64_t now = client_now_ns(*client);
  if (server->overture.phase == ServerPhase::waiting) {
    if (platform::link_timer_left(&server->overture.timer, now) == 0) connect_server(client, server);
    return;
  }
  if (server->overture.phase == ServerPhase::connecting) {
    platform::Error error;
    platform::LinkResult result = connected_message_stream(&server->messages, &error);
    if (result == platform::LinkResult::failed) return lose_server(client, server, error.text);
    if (result != platform::LinkResult::done) return;
    greet_server(client, server);
  }
  read_server(client, server);
  if (server->overture.phase == ServerPhase::waiting) return;
  if (is_light_overdue(client, server)) return lose_server(client, server, "it did not send its light in time");
  if (!is_awaited(*client, *server)) {
    server->overture.timer = platform::link_timer(now, silence_limit_ns(*client, *server));
    // Where servers send light, one may wait long for its first rows.
    const bool is_spare =
        server->overture.phase >= ServerPhase::probing && client->options.light.split != SplitKind::rows;
    if ((server->overture.phase == ServerPhase::ready || is_spare) && now >= server->link.ping_due_ns) {
      server->link.ping_due_ns = now + kIdlePingNs;
      send_ping(client, server, 0);
    }
  } else {
    std::uint64_t left = platform::link_timer_left(&server->overture.timer, client_now_ns(*client));
    std::uint64_t half = silence_limit_ns(*client, *server) / 2;
    // The server may be alive but too busy for rows: half-way through the limit it is pinged and gets the other half to
    // answer, even if the device was too busy to poll for longer than that.
    if (server->overture.phase >= ServerPhase::probing && server->link.ping_id == 0 && left < half) {
      server->overture.timer = platform::link_timer(client_now_ns(*client), half);
      send_ping(client, server, 0);
    } else if (left == 0) {
      return lose_server(client, server, "it does not answer");
    }
  }
  flush_server(client, server);
}

}  // namespace pocketray