#include <algorithm>

#include "engine/row_costs.h"
#include "remote/server/state.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kSliceNs = 20'000'000;  // of the CPU, before another client may have its turn

std::uint64_t elapsed(std::uint64_t begin, std::uint64_t end) { return end > begin ? end - begin : 0; }

// Closes the books on frames that have come to their end, and lets time forgive.
void settle(Server* server, std::uint64_t now) {
  std::uint64_t passed = elapsed(server->settled_ns, now), count = 1;
  server->settled_ns = now;
  for (Session& s : server->sessions) {
    if (s.phase != SessionPhase::unused) ++count;
    if (s.address < 0 || s.ended_took_ns == 0) continue;
    end_frame(&s.account, s.ended_took_ns, s.ended_sent_ns);
    end_frame(&server->addresses[static_cast<std::size_t>(s.address)].account, s.ended_took_ns, s.ended_sent_ns);
    s.ended_took_ns = s.ended_sent_ns = 0;
  }
  for (Session& s : server->sessions) forgive(&s.account, passed, count);
  for (Address& address : server->addresses) forgive(&address.account, passed, count);
}

bool has_turn(const Server& server, const Session& s) {
  if (s.phase != SessionPhase::serving) return false;
  return can_work(s) || (in_turn(server) && (wants_messages(s) || has_chunk(s)));
}

// One of those with something to do: of the address whose turn it is, the session whose turn it is. Notes since when
// they wait. -1: there is none.
int choose_session(Server* server) {
  std::uint64_t now = now_ns(server);
  settle(server, now);
  for (Address& address : server->addresses) address.waits = false;
  for (Session& s : server->sessions) {
    if (s.phase != SessionPhase::serving || !can_work(s)) {
      s.waiting_since_ns = 0;
    } else if (s.waiting_since_ns == 0) {
      s.waiting_since_ns = now;
    }
    if (s.address < 0) continue;
    Address* address = &server->addresses[static_cast<std::size_t>(s.address)];
    bool waits = has_turn(*server, s);
    address->waits = address->waits || waits;
    note(&address->lanes, &s.account, waits);
  }
  int first[2] = {-1, -1};
  for (std::size_t i = 0; i < server->addresses.size(); ++i) {
    Address* a = &server->addresses[i];
    note(&server->lanes, &a->account, a->waits);
    int* best = &first[a->account.heavy ? 1 : 0];
    bool goes = *best < 0 || goes_before(a->account, server->addresses[static_cast<std::size_t>(*best)].account);
    if (a->waits && goes) *best = static_cast<int>(i);
  }
  int chosen = first[choose_lane(&server->lanes, first[0] >= 0, first[1] >= 0)];
  if (chosen < 0) return -1;

  first[0] = first[1] = -1;
  for (std::size_t i = 0; i < server->sessions.size(); ++i) {
    const Session& s = server->sessions[i];
    if (s.address != chosen || !s.account.waits) continue;
    int* best = &first[s.account.heavy ? 1 : 0];
    bool goes = *best < 0 || goes_before(s.account, server->sessions[static_cast<std::size_t>(*best)].account);
    if (goes) *best = static_cast<int>(i);
  }
  Lanes* lanes = &server->addresses[static_cast<std::size_t>(chosen)].lanes;
  return first[choose_lane(lanes, first[0] >= 0, first[1] >= 0)];
}

Pace pace_of(const Server& server, const Session& s, const Slice& slice) {
  std::uint32_t end = s.job.traced_begin, row_count = std::max(slice.row_count, slice.pixel_count > 0 ? 1u : 0u);
  return pace_of_rows(server.options.pace, server.options.row_costs, end - row_count, end);
}

// How long the work was, by the CPU that is emulated if there is one.
std::uint64_t work_ns(const Server& server, const Session& s, const Work& work, std::uint64_t took) {
  const ServerOptions& o = server.options;
  if (!is_paced(o.pace)) return took;
  if (work.message_count == 0) return paced_ns(pace_of(server, s, work.slice), work.slice.pixel_count, took);
  return static_cast<std::uint64_t>(work.message_count) * o.message_ns + work.byte_count * o.byte_ps / 1000;
}

// Takes messages, queues what waited for room, prepares a frame or traces a part of it.
void begin_work(Server* server, int index) {
  Session* s = &server->sessions[static_cast<std::size_t>(index)];
  Work* work = &server->work;
  *work = Work();
  work->session = index;
  work->address = s->address;
  work->job_number = s->job_number;
  work->is_job = !(in_turn(*server) && (wants_messages(*s) || has_chunk(*s)));
  std::uint64_t start = now_ns(server), waited_since = s->waiting_since_ns;
  if (!work->is_job && wants_messages(*s)) {
    std::uint64_t queued = s->queued_count;
    work->message_count = take_messages(server, s);
    work->byte_count = s->queued_count - queued;
  } else if (!work->is_job) {
    send_chunks(s);
  } else {
    WireError code;
    JobTools tools = {server->options.thread_count, server->workers};
    Status status = step_job(s, tools, kSliceNs, &work->slice, &code);
    if (!status.ok) {
      std::uint32_t frame = s->job.request.frame;
      drop_job(s);
      refuse(server, s, code, frame, status.message);
    }
  }

  std::uint64_t now = now_ns(server), took = elapsed(start, now);
  work->begin_ns = start;
  work->end_ns = now;
  if (is_paced(server->options.pace)) {
    took = work_ns(*server, *s, *work, took);
    // Who waited already when the CPU became free was begun with at that moment.
    if (work->is_job && waited_since < server->cpu_free_ns && server->cpu_free_ns < start)
      work->begin_ns = server->cpu_free_ns;
    if (work->begin_ns + took > now) work->end_ns = work->begin_ns + took;
    server->cpu_free_ns = work->end_ns;
  }
  work->timer = platform::link_timer(now, work->end_ns - now);
}

void end_work(Server* server) {
  Work* work = &server->work;
  Session* s = &server->sessions[static_cast<std::size_t>(work->session)];
  work->session = -1;
  std::uint64_t took = elapsed(work->begin_ns, work->end_ns);
  bool goes_on = work->is_job && has_job(*s) && s->job_number == work->job_number;
  bool is_job = work->is_job && s->address == work->address;
  account_for(server, s, took, is_job);
  if (is_job) (goes_on ? s->job.took_ns : s->ended_took_ns) += took;  // of a frame that was given up: in vain
  if (!goes_on) return;
  if (work->slice.pixel_count > 0) end_slice(s, work->slice, took, elapsed(s->waiting_since_ns, work->end_ns));
  s->waiting_since_ns = work->end_ns;
  std::uint64_t start = now_ns(server);
  send_chunks(s);
  std::uint64_t sending = elapsed(start, now_ns(server));
  account_for(server, s, sending, true);
  if (has_job(*s)) {
    s->job.took_ns += sending;
  } else {
    s->ended_took_ns += sending;
    s->ended_sent_ns += sending;
  }
  if (s->pixel_ps) server->pixel_ps = s->pixel_ps;
}

}  // namespace

void account_for(Server* server, Session* s, std::uint64_t took, bool is_job) {
  if (s->address < 0) return;
  Address* address = &server->addresses[static_cast<std::size_t>(s->address)];
  charge(&server->lanes, &address->account, took);
  charge(&address->lanes, &s->account, took);
  for (Account* account : {&address->account, &s->account}) {
    if (is_job)
      account->job_ns += took;
    else
      owe(account, took);
  }
}

void refuse(Server* server, Session* session, WireError code, std::uint32_t frame, const char* reason) {
  send_error(session, code, frame);
  log_line(&server->log, now_ns(server), "%s: frame %u is refused: %s", session->name, frame, reason);
}

void do_work(Server* server) {
  if (server->work.session < 0) {
    int chosen = choose_session(server);
    if (chosen < 0) return;
    begin_work(server, chosen);
  }
  if (platform::link_timer_left(&server->work.timer, now_ns(server)) == 0) end_work(server);
}

std::uint64_t work_due_ns(Server* server) {
  if (server->work.session >= 0) return platform::link_timer_left(&server->work.timer, now_ns(server));
  return choose_session(server) >= 0 ? 0 : ~std::uint64_t(0);
}

}  // namespace pocketray
