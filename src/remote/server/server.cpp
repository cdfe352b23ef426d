#include "remote/server/server.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "base/check.h"
#include "remote/server/state.h"
#include "session/source.h"

namespace pocketray {
namespace {

using platform::LinkResult;

// Chosen: a few round trips of a slow link.
constexpr std::uint64_t kLingerNs = 2'000'000'000;  // for a leaving client to read the reason
constexpr std::uint64_t kFarewellNs = 500'000'000;  // for telling all clients that the server shuts down

bool accepts(Server* server) {
  return !server->accept_rests || platform::link_timer_left(&server->accept_timer, now_ns(server)) == 0;
}

void write_session(Server* server, Session* session) {
  std::uint64_t sent = session->messages.bytes_out;
  platform::Error error;
  bool open = flush_message_stream(&session->messages, &error);
  if (session->messages.bytes_out > sent)
    session->stall_timer = platform::link_timer(now_ns(server), server->options.stall_timeout_ns);
  if (!open) end_session(server, session, error.text);
}

void read_and_account(Server* server, Session* session) {
  const std::uint64_t start = cpu_now_ns(server);
  read_session(server, session);
  const std::uint64_t now = cpu_now_ns(server);
  if (session->phase != SessionPhase::unused && in_turn(*server) && now > start)
    account_for(server, session, now - start, false);
}

// Sends queued output, and rows that wait for room unless they must also wait for their turn.
void send_session(Server* server, Session* session) {
  for (;;) {
    std::uint64_t start = cpu_now_ns(server), queued_before = queued_bytes(session->messages);
    write_session(server, session);
    std::uint64_t now = cpu_now_ns(server);
    if (in_turn(*server) && now > start && queued_before > 0) account_for(server, session, now - start, false);
    if (session->phase != SessionPhase::serving || in_turn(*server)) return;
    std::size_t queued = queued_bytes(session->messages);
    send_chunks(session);
    if (queued_bytes(session->messages) == queued) return;
  }
}

// True if the session waits for the rest of a message, for the client to read its output, or for nothing.
bool awaits_message(const Session& session) {
  return session.phase == SessionPhase::serving && input_bytes(session.messages) > 0;
}
bool awaits_room(const Session& session) { return queued_bytes(session.messages) > 0; }
bool is_idle(const Session& session) {
  return session.phase == SessionPhase::serving && !has_job(session) && queued_bytes(session.messages) == 0;
}

// Nanoseconds until the first of the session's timers expires.
std::uint64_t session_due_ns(Session* session, std::uint64_t now) {
  std::uint64_t due = ~std::uint64_t(0);
  auto consider = [&](bool counts, platform::LinkTimer* timer) {
    if (!counts) return;
    std::uint64_t left = platform::link_timer_left(timer, now);
    if (left < due) due = left;
  };
  consider(awaits_message(*session), &session->message_timer);
  consider(awaits_room(*session), &session->stall_timer);
  consider(is_idle(*session), &session->idle_timer);
  consider(session->phase == SessionPhase::leaving, &session->leave_timer);
  return due;
}

void look_at_clock(Server* server, Session* session) {
  std::uint64_t now = now_ns(server);
  auto over = [&](bool counts, platform::LinkTimer* timer) {
    if (counts) return platform::link_timer_left(timer, now) == 0;
    timer->last_ns = now;
    timer->passed_ns = 0;
    return false;
  };
  if (session->phase == SessionPhase::leaving) {
    if (over(true, &session->leave_timer)) end_session(server, session, session->reason);
    return;
  }
  if (over(awaits_room(*session), &session->stall_timer))
    return end_session(server, session, "it does not read its answers");
  if (over(awaits_message(*session), &session->message_timer))
    return leave(server, session, nullptr, "it stopped in the middle of a message");
  if (over(is_idle(*session), &session->idle_timer))
    return leave(server, session, nullptr, "it was silent for too long");
}

// Blocks until there is something to do.
void wait_for_news(Server* server, std::uint64_t timeout_ns) {
  std::uint64_t due = work_due_ns(server), now = now_ns(server);
  if (timeout_ns < due) due = timeout_ns;
  platform::LinkWait* wait = server->waits.data();
  *wait++ = {server->listener, accepts(server), false};
  if (server->accept_rests) due = std::min(due, platform::link_timer_left(&server->accept_timer, now));
  for (Session& session : server->sessions) {
    *wait = platform::LinkWait();
    if (session.phase != SessionPhase::unused) {
      const MessageStream& messages = session.messages;
      bool has_room = input_bytes(messages) < messages.in.count;
      *wait = {messages.stream, has_room && !messages.ended, queued_bytes(messages) != 0};
      std::uint64_t session_due = wants_messages(session) ? 0 : session_due_ns(&session, now);
      if (session_due < due) due = session_due;
    }
    ++wait;
  }
  for (Guest& guest : server->guests) {
    *wait++ = {guest.messages.stream, is_open(guest), is_open(guest) && queued_bytes(guest.messages) > 0};
    if (!is_open(guest)) continue;
    std::uint64_t left = platform::link_timer_left(&guest.timer, now);
    if (left < due) due = left;
  }
  CHECK_EQ(std::size_t(wait - server->waits.data()), server->waits.size());
  server->net->poll(server->link, server->waits.data(), static_cast<int>(server->waits.size()), due);
}

// Queues a last message for every client and sends what it can at once.
void say_farewell(Server* server) {
  for (Session& session : server->sessions)
    if (session.phase == SessionPhase::serving && output_room(session.messages) >= kReplyBytesMax)
      send_error(&session, WireError::closing, 0);
  platform::LinkTimer timer = platform::link_timer(now_ns(server), kFarewellNs);
  for (;;) {
    bool waits = false;
    for (std::size_t i = 0; i < server->sessions.size(); ++i) {
      Session* session = &server->sessions[i];
      if (session->phase != SessionPhase::unused) write_session(server, session);
      if (session->phase != SessionPhase::unused) discard_input(&session->messages);
      bool unsent = session->phase != SessionPhase::unused && queued_bytes(session->messages) > 0;
      server->waits[i] = {session->messages.stream, false, unsent};
      waits = waits || unsent;
    }
    std::uint64_t left = platform::link_timer_left(&timer, now_ns(server));
    if (!waits || left == 0) return;
    server->net->poll(server->link, server->waits.data(), static_cast<int>(server->sessions.size()), left);
  }
}

Status check_options(const ServerOptions& o) {
  if (o.client_count_max < 1 || o.client_count_max > kServerClientsMax)
    return failure("the number of clients must lie in 1 … %d, not %d", kServerClientsMax, o.client_count_max);
  if (o.guest_count_max < 1 || o.guest_count_max > kServerClientsMax)
    return failure("the number of guests must lie in 1 … %d, not %d", kServerClientsMax, o.guest_count_max);
  if (o.client_memory_bytes < kSessionBytesMin)
    return failure("the memory per client is %zu bytes: it must be at least %zu", o.client_memory_bytes,
                   kSessionBytesMin);
  if (o.thread_count < 1 || o.thread_count > kThreadCountMax)
    return failure("the number of threads is %u: it must lie in 1 … %u", o.thread_count, kThreadCountMax);
  if (o.image_side_max < 1 || o.image_side_max > kImageSideMax)
    return failure("the longest picture side may be at most %u pixels, not %u", kImageSideMax, o.image_side_max);
  CHECK(!o.helpers || !is_paced(o.pace));  // an emulated CPU works alone
  return success();
}

Status take_memory(Server* server) {
  const ServerOptions& o = server->options;
  server->sessions.resize(static_cast<std::size_t>(o.client_count_max));
  server->guests.resize(static_cast<std::size_t>(o.guest_count_max));
  server->addresses.reserve(kAddressCountMax);
  server->waits.resize(1 + server->sessions.size() + server->guests.size());
  for (Session& session : server->sessions) {
    void* block = take_block(o.client_memory_bytes);
    if (!block)
      return failure("not enough memory for %d clients of %.0f MiB each: lower one of them", o.client_count_max,
                     static_cast<double>(o.client_memory_bytes) / (1 << 20));
    server->blocks.push_back(block);
    make_session(block, o.client_memory_bytes, &session);
  }
  return success();
}

void release(Server* server) {
  if (server->listener >= 0) server->net->close(server->link, server->listener);
  stop_workers(server->workers);
  for (void* block : server->blocks) give_block_back(block);
  delete server;
}

}  // namespace

void leave(Server* server, Session* session, const WireError* code, const char* reason) {
  CHECK(session->phase == SessionPhase::serving);
  CHECK(reason != nullptr);
  drop_job(session);
  if (code) send_error(session, *code, 0);
  std::snprintf(session->reason, sizeof session->reason, "%s", reason);
  session->phase = SessionPhase::leaving;
  drop_input(&session->messages);
  session->more_to_take = false;
  session->leave_timer = platform::link_timer(now_ns(server), kLingerNs);
  if (!code) end_session(server, session, reason);
}

void end_session(Server* server, Session* session, const char* reason) {
  CHECK(session->phase != SessionPhase::unused);
  CHECK_GE(session->messages.stream, 0);
  close_message_stream(&session->messages);
  if (session->phase == SessionPhase::leaving && session->reason[0]) reason = session->reason;
  session->phase = SessionPhase::unused;
  drop_job(session);
  server->totals.frame_count += session->frame_count;
  server->totals.row_count += session->row_count;
  server->totals.byte_count += session->messages.bytes_out;
  log_line(&server->log, now_ns(server), "%s disconnected after %llu frames, %llu rows, %.1f KiB: %s", session->name,
           static_cast<unsigned long long>(session->frame_count), static_cast<unsigned long long>(session->row_count),
           static_cast<double>(session->messages.bytes_out) / 1024, reason);
}

int server_stream_count(const ServerOptions& options) { return 2 + options.client_count_max + options.guest_count_max; }

Status open_server(const ServerOptions& options, const SceneStore& store, platform::Link* link,
                   const platform::LinkAddress& address, Server** result) {
  CHECK(link != nullptr && link->backend != nullptr && result != nullptr);
  *result = nullptr;
  RETURN_IF_ERROR(check_options(options));
  Server* server = new Server;
  server->options = options;
  server->store = &store;
  server->link = link;
  server->net = link->backend;
  server->log.write = options.log;
  server->log.context = options.log_context;
  Status status = take_memory(server);
  if (status.ok) {
    platform::Error error;
    server->listener = server->net->listen(link, address, &error);
    if (server->listener < 0) status = failure("%s", error.text);
  }
  if (!status.ok) {
    release(server);
    return status;
  }
  server->workers = start_workers(options.thread_count);
  *result = server;
  return success();
}

const char* server_address(const Server& server) { return server.net->stream_name(server.link, server.listener); }

void step_server(Server* server, std::uint64_t timeout_ns) {
  CHECK(server != nullptr);
  wait_for_news(server, timeout_ns);
  const platform::LinkWait* wait = server->waits.data();
  bool comes = (wait++)->can_read;
  for (Session& session : server->sessions) {
    bool has_news = (wait++)->can_read;
    if (session.phase != SessionPhase::unused && (has_news || input_bytes(session.messages) > 0))
      read_and_account(server, &session);
    if (session.phase == SessionPhase::serving && !in_turn(*server) && wants_messages(session))
      take_messages(server, &session);
  }
  tend_guests(server, comes);
  do_work(server);
  for (Session& session : server->sessions) {
    if (session.phase != SessionPhase::unused) send_session(server, &session);
    if (session.phase != SessionPhase::unused) look_at_clock(server, &session);
  }
}

ServerTotals server_totals(const Server& server) {
  ServerTotals totals = server.totals;
  for (const Session& session : server.sessions)
    if (session.phase != SessionPhase::unused) {
      totals.frame_count += session.frame_count;
      totals.row_count += session.row_count;
      totals.byte_count += session.messages.bytes_out;
    }
  return totals;
}

void close_server(Server* server) {
  if (!server) return;
  say_farewell(server);
  for (Session& session : server->sessions)
    if (session.phase != SessionPhase::unused) end_session(server, &session, "this server shut down");
  for (Guest& guest : server->guests)
    if (is_open(guest)) close_guest(&guest);
  release(server);
}

}  // namespace pocketray
