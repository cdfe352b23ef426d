// One server as the device sees it: connection, overture, rows that come, failures.
#include <cinttypes>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kIdlePingNs = 500'000'000;  // between two looks at a server that gets no rows
constexpr std::uint64_t kLastingWaits = 10;   // a connection that was of use for so many times the wait before it was a
                                              // sound one: the next try is soon
constexpr std::uint32_t kLookMessages = 256;  // of a server in one look, and no more rows than a picture has
void tell(Client* c, const char* format, ...) __attribute__((format(printf, 2, 3)));
void tell(Client* c, const char* format, ...) {
  if (!c->options.log) return;
  char line[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  c->options.log(c->options.log_context, line);
}

void connect_server(Client* c, RemoteServer* s) {
  platform::Error error;
  int stream = c->link->backend->connect(c->link, s->address, c->options.connect_timeout_ns, &error);
  if (stream < 0) {
    lose_server(c, s, error.text);
    return;
  }
  start_message_stream(&s->messages, c->link, stream);
  enter(c, s, ServerPhase::connecting);
}

void greet_server(Client* c, RemoteServer* s) {
  restart_row_decoder(s->decoder);
  s->pings_answered = s->pings_missed = 0, s->ping_id = 0, s->round_trip_ns = 0;
  s->chunk_count = 0, s->chunk_growth = 0, s->unanswered = false;
  s->quiet_until_ns = s->anew_ns = 0;
  s->asked = FrameRequest();
  s->due_end = 0, s->late_rows = 0;
  s->frame = ServerFrame();
  enter(c, s, ServerPhase::greeting);
  Message message;
  message.type = MessageType::hello;
  message.hello.image_side_max = static_cast<std::uint16_t>(kImageSideMax);
  message.hello.message_bytes_max = s->messages.in.count;
  send(c, s, message);
}

void take_hello(Client* c, RemoteServer* s, const Hello& hello) {
  Status same_version = check_version(hello);
  if (!same_version.ok) return lose_server(c, s, same_version.message);
  if (c->settings.width > hello.image_side_max || c->settings.height > hello.image_side_max)
    return lose_server(c, s, "it does not render pictures of that size: use a smaller --size");
  enter(c, s, ServerPhase::asking);
  Message message;
  message.type = MessageType::scene_query;
  message.scene_query.hash = c->scene;
  send(c, s, message);
}

void take_scene_entry(Client* c, RemoteServer* s, const SceneEntry& entry) {
  if (entry.byte_count == 0)
    return lose_server(c, s, "it does not have this scene: put the same file into the folder it serves (--scenes)");
  if (entry.hash != c->scene) return lose_server(c, s, kUnasked);
  enter(c, s, ServerPhase::measuring);
  send_ping(c, s, 0);
}

// Whether a server owes these rows: the next of what it was asked for last, from the bottom upward, or some that were
// under way when that took the place of an earlier request. None is owed twice, so that what a server can make the
// device decode is bounded by what the device asked for. A chunk of the last request says that those before it are
// over.
bool takes_owed_rows(RemoteServer* s, const RowChunk& chunk) {
  std::uint32_t end = std::uint32_t(chunk.row_begin) + chunk.row_count;
  if (chunk.frame == s->asked.frame && end == s->due_end && chunk.row_begin >= s->asked.row_begin) {
    s->due_end = chunk.row_begin;
    s->late_rows = s->late_at_ping = 0;
    return true;
  }
  if (chunk.frame > s->asked.frame || chunk.row_count > s->late_rows) return false;
  s->late_rows -= chunk.row_count;
  s->late_at_ping -= s->late_at_ping < chunk.row_count ? s->late_at_ping : chunk.row_count;
  return true;
}

void take_chunk(Client* c, RemoteServer* s, RowChunk chunk) {
  if (!takes_owed_rows(s, chunk)) return lose_server(c, s, "it sends rows that it was not asked for");
  if (chunk.bytes.count > encoded_bytes_max(s->decoder->state.shape, chunk.row_count))
    return lose_server(c, s, "it sends more bytes than its rows can take");
  // Decoded twice or in another order, rows would spoil the picture that the decoder keeps.
  if (!take_chunk_number(&chunk, s->chunk_count++)) return lose_server(c, s, "it sends rows out of turn");
  std::uint64_t begin_ns = client_now_ns(*c);
  if (!decode_rows(s->decoder, chunk)) return lose_server(c, s, "it sends rows that cannot be decoded");
  std::uint64_t unpacked_ns = client_now_ns(*c) - begin_ns;
  if (c->options.pace.slowdown > 1) {
    std::uint64_t paced = static_cast<std::uint64_t>(static_cast<double>(unpacked_ns) * c->options.pace.slowdown);
    work_until(c, begin_ns + paced);
    unpacked_ns = paced;
  }
  std::uint32_t bytes = row_chunk_prefix_bytes() + chunk.bytes.count;
  observe_unpack(&c->model, bytes, static_cast<double>(unpacked_ns));
  accept_chunk(c, s, chunk, bytes);
}

void take(Client* c, RemoteServer* s, const Message& message) {
  bool greeted = s->phase != ServerPhase::greeting;
  if (message.type == MessageType::hello && !greeted) return take_hello(c, s, message.hello);
  if (message.type == MessageType::scene_entry && s->phase == ServerPhase::asking)
    return take_scene_entry(c, s, message.scene_entry);
  if (message.type == MessageType::pong && greeted) return take_pong(c, s, message.pong);
  if (message.type == MessageType::row_chunk && s->phase >= ServerPhase::probing)
    return take_chunk(c, s, message.row_chunk);
  if (message.type == MessageType::error) return lose_server(c, s, wire_error_text(message.error.code));
  lose_server(c, s, kUnasked);
}

// Whether an answer or rows are awaited.
bool is_awaited(const Client& c, const RemoteServer& s) {
  if (s.phase == ServerPhase::ready || s.phase == ServerPhase::probing)
    return s.frame.open || s.ping_id != 0 || s.unanswered;
  (void)c;
  return s.phase != ServerPhase::waiting;
}

// Takes what has come, but no more than a frame can bring: whatever a server sends, the device goes on.
void read_server(Client* c, RemoteServer* s) {
  platform::Error error;
  std::uint32_t messages = 0, rows = 0;
  s->more = false;
  for (;;) {
    if (!pump_message_stream(&s->messages, &error)) return lose_server(c, s, error.text);
    bool took = false;
    for (;;) {
      s->more = messages == kLookMessages || rows >= c->settings.height;
      if (s->more) return;
      Message message;
      DecodeState state = take_message(&s->messages, &message);
      if (state == DecodeState::malformed) return lose_server(c, s, "what it sends is no message of the protocol");
      if (state == DecodeState::need_more) break;
      took = true;
      ++messages;
      if (message.type == MessageType::row_chunk) rows += message.row_chunk.row_count;
      s->unanswered = false;
      s->timer = platform::link_timer(client_now_ns(*c), silence_limit_ns(*c, *s));
      take(c, s, message);
      if (s->phase == ServerPhase::waiting) return;
    }
    if (!took) return;
  }
}

}  // namespace

void enter(Client* c, RemoteServer* s, ServerPhase phase) {
  s->phase = phase;
  s->timer = platform::link_timer(client_now_ns(*c), silence_limit_ns(*c, *s));
}

void send(Client* c, RemoteServer* s, const Message& message) {
  if (!send_message(&s->messages, message)) lose_server(c, s, "it does not read what it is sent");
}

const char* wire_error_text(WireError code) {
  switch (code) {
    case WireError::wrong_version:
      return "it speaks another version of the protocol: update one of the two";
    case WireError::malformed:
      return "it could not read what it was sent";
    case WireError::unknown_scene:
      return "it does not have this scene: put the same file into the folder it serves (--scenes)";
    case WireError::too_large:
      return "the picture is too large for it: use a smaller --size, or serve with more --memory";
    case WireError::bad_request:
      return "it cannot render with these settings";
    case WireError::busy:
      return "it has as many clients as it takes: serve with more --clients";
    case WireError::closing:
      return "it was ended";
  }
  return "it reports an error";
}

const char* phase_text(ServerPhase phase) {
  switch (phase) {
    case ServerPhase::waiting:
      return "not in reach";
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

std::uint64_t silence_limit_ns(const Client& c, const RemoteServer& s) {
  const ClientOptions& o = c.options;
  if (s.phase == ServerPhase::connecting) return o.connect_timeout_ns;
  return s.phase == ServerPhase::probing ? o.prepare_timeout_ns : o.silence_timeout_ns;
}

void lose_server(Client* c, RemoteServer* s, const char* reason) {
  close_message_stream(&s->messages);
  s->more = false;
  std::uint32_t i = index_of(*c, s);
  c->model.servers[i].connected = false;
  s->frame.open = false;
  s->phase = ServerPhase::waiting;
  std::uint64_t now = client_now_ns(*c);
  if (s->useful_ns > 0 && now - s->useful_ns >= kLastingWaits * s->retry_ns) s->retry_ns = 0;
  s->useful_ns = 0;
  std::uint64_t next = 2 * s->retry_ns;
  s->retry_ns = next < c->options.retry_ns_min   ? c->options.retry_ns_min
                : next > c->options.retry_ns_max ? c->options.retry_ns_max
                                                 : next;
  s->timer = platform::link_timer(now, s->retry_ns);
  const char* name = s->address.text;
  bool named = std::strncmp(reason, name, std::strlen(name)) == 0;  // the link's errors begin with it
  if (!s->told)
    tell(c, "server %s%s%s; going on without it, and trying again", named ? "" : name, named ? "" : ": ", reason);
  s->told = true;
}

void flush_server(Client* c, RemoteServer* s) {
  platform::Error error;
  if (s->phase != ServerPhase::waiting && !flush_message_stream(&s->messages, &error)) lose_server(c, s, error.text);
}

void server_is_ready(Client* c, RemoteServer* s) {
  s->phase = ServerPhase::ready;
  s->ping_due_ns = client_now_ns(*c) + kIdlePingNs;
  c->model.servers[index_of(*c, s)].connected = true;
  if (s->useful_ns > 0) server_is_useful(c, s);
}

void server_is_useful(Client* c, RemoteServer* s) {
  if (s->useful_ns == 0) s->useful_ns = client_now_ns(*c);
  if (s->phase != ServerPhase::ready) return;
  if (s->told) tell(c, "server %s is in use again", s->address.text);
  s->told = false;
}

void advance_server(Client* c, RemoteServer* s) {
  if (s->lied) return;
  std::uint64_t now = client_now_ns(*c);
  if (s->phase == ServerPhase::waiting) {
    if (platform::link_timer_left(&s->timer, now) == 0) connect_server(c, s);
    return;
  }
  if (s->phase == ServerPhase::connecting) {
    platform::Error error;
    platform::LinkResult result = c->link->backend->connected(c->link, s->messages.stream, &error);
    if (result == platform::LinkResult::failed) return lose_server(c, s, error.text);
    if (result != platform::LinkResult::done) return;
    greet_server(c, s);
  }
  read_server(c, s);
  if (s->phase == ServerPhase::waiting) return;
  if (!is_awaited(*c, *s)) {
    s->timer = platform::link_timer(now, silence_limit_ns(*c, *s));
    if (s->phase == ServerPhase::ready && now >= s->ping_due_ns) {
      s->ping_due_ns = now + kIdlePingNs;
      send_ping(c, s, 0);
    }
  } else {
    std::uint64_t left = platform::link_timer_left(&s->timer, client_now_ns(*c));
    std::uint64_t half = silence_limit_ns(*c, *s) / 2;
    // It may have no time for rows, and yet be there: asked, it has the other half to answer, even where the device was
    // too busy to look for longer than that.
    if (s->phase >= ServerPhase::probing && s->ping_id == 0 && left < half) {
      s->timer = platform::link_timer(client_now_ns(*c), half);
      send_ping(c, s, 0);
    } else if (left == 0) {
      return lose_server(c, s, "it does not answer");
    }
  }
  flush_server(c, s);
}

}  // namespace pocketray