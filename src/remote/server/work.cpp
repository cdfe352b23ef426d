#include <algorithm>

#include "base/check.h"
#include "engine/row_costs.h"
#include "remote/server/state.h"

namespace pocketray {
namespace {

// Chosen: coding takes a tenth of a slice's time, for which all threads but one would wait.
constexpr double kBesideSlices = 10;

std::uint64_t elapsed(std::uint64_t begin, std::uint64_t end) { return end > begin ? end - begin : 0; }

// Time by both clocks, which may be one.
struct Times {
  std::uint64_t now, cpu;
};
Times times_of(Server* server) {
  const std::uint64_t now = now_ns(server);
  return {now, server->options.cpu_ns ? server->options.cpu_ns() : now};
}

// Accounts for finished frames and forgives debt for the time passed.
void settle(Server* server, std::uint64_t now) {
  std::uint64_t passed = elapsed(server->settled_ns, now), count = 1;
  server->settled_ns = now;
  for (Session& session : server->sessions) {
    if (session.phase != SessionPhase::unused) ++count;
    if (session.address < 0 || session.ended_took_ns == 0) continue;
    for (Account* account : {&session.account, &server->addresses[static_cast<std::size_t>(session.address)].account})
      end_frame(account, session.ended_took_ns, session.ended_sent_ns, session.ended_build_ns);
    session.ended_took_ns = session.ended_sent_ns = session.ended_build_ns = 0;
  }
  for (Session& session : server->sessions) {
    forgive(&session.account, passed, count);
    observe_demand(&session.account, passed);
  }
  for (Address& address : server->addresses) {
    forgive(&address.account, passed, count);
    observe_demand(&address.account, passed);
  }
}

// Sets each client's price anew.
void set_prices(Server* server) {
  clear_demand(&server->lanes);
  for (Address& address : server->addresses) {
    add_demand(&server->lanes, address.account);
    clear_demand(&address.lanes);
  }
  auto address_of = [&](const Session& session) -> Address& {
    return server->addresses[static_cast<std::size_t>(session.address)];
  };
  for (const Session& session : server->sessions)
    if (session.address >= 0) add_demand(&address_of(session).lanes, session.account);
  for (Session& session : server->sessions) {
    if (session.phase != SessionPhase::serving || session.address < 0) continue;
    const Address& address = address_of(session);
    session.price = price_of(crowding(server->lanes, address.account), crowding(address.lanes, session.account));
  }
}

bool has_turn(const Server& server, const Session& session) {
  if (session.phase != SessionPhase::serving) return false;
  return can_work(session) || (in_turn(server) && (wants_messages(session) || has_chunk(session)));
}

// Chooses among sessions with work: the next session of the next address. Records when each began to wait. Returns -1
// if there is none.
int choose_session(Server* server) {
  std::uint64_t now = now_ns(server);
  settle(server, now);
  for (Address& address : server->addresses) address.waits = false;
  for (Session& session : server->sessions) {
    if (session.phase != SessionPhase::serving || !can_work(session)) {
      session.waiting_since_ns = 0;
    } else if (session.waiting_since_ns == 0) {
      session.waiting_since_ns = now;
    }
    if (session.address < 0) continue;
    Address* address = &server->addresses[static_cast<std::size_t>(session.address)];
    bool waits = has_turn(*server, session);
    address->waits = address->waits || waits;
    note(&address->lanes, &session.account, waits);
  }
  Choice choice;
  for (std::size_t i = 0; i < server->addresses.size(); ++i) {
    Address* a = &server->addresses[i];
    note(&server->lanes, &a->account, a->waits);
    consider(&choice, static_cast<int>(i), a->account);
  }
  set_prices(server);
  const int chosen = choose(&server->lanes, choice);
  if (chosen < 0) return -1;
  choice = Choice();
  for (std::size_t i = 0; i < server->sessions.size(); ++i)
    if (server->sessions[i].address == chosen) consider(&choice, static_cast<int>(i), server->sessions[i].account);
  return choose(&server->addresses[static_cast<std::size_t>(chosen)].lanes, choice);
}

// The worse of its lanes: its own among its address's connections, and its address's among the others.
Lane lane_of(const Server& server, const Session& session) {
  const Address& address = server.addresses[static_cast<std::size_t>(session.address)];
  return std::max(session.account.lane, address.account.lane);
}

// Short for sessions that a client of a better lane might have to wait for.
std::uint64_t slice_ns(const Server& server, const Session& session) {
  const Lane lane = lane_of(server, session);
  for (const Session& other : server.sessions)
    if (other.phase == SessionPhase::serving && lane_of(server, other) < lane) return kShortSliceNs;
  return kSliceNs;
}

Pace pace_of(const Server& server, const Session& session, const Slice& slice) {
  const std::uint32_t row_count = std::max(slice.row_count, slice.pixel_count > 0 ? 1u : 0u);
  if (!server.options.row_costs || row_count == 0 || slice.is_probe || slice.is_coarse || slice.is_light)
    return server.options.pace;
  RowRange ranges[kRunCountMax];
  Pace pace = server.options.pace;
  pace.ns_per_pixel = 0;
  for (std::uint32_t i = 0, count = next_ranges(session.job, row_count, ranges); i < count; ++i)
    pace.ns_per_pixel +=
        pace_of_rows(server.options.pace, server.options.row_costs, ranges[i].begin, ranges[i].end).ns_per_pixel *
        (ranges[i].end - ranges[i].begin) / row_count;
  return pace;
}

// Duration of the work, on the emulated CPU if there is one.
std::uint64_t work_ns(const Server& server, const Session& session, const Work& work, std::uint64_t took) {
  const ServerOptions& o = server.options;
  if (!is_paced(o.pace)) return took;
  if (work.slice.is_preparation) return paced_prepare_ns(o.pace, took);
  if (work.message_count == 0) return paced_ns(pace_of(server, session, work.slice), work.slice.traced_count, took);
  return static_cast<std::uint64_t>(work.message_count) * o.message_ns + work.byte_count * o.byte_ps / 1000;
}

// Time of coding rows since the last call, on the emulated CPU if there is one.
std::uint64_t take_coding_ns(const Server& server, Session* session) {
  const std::uint64_t pixels = session->coded_pixels, bytes = session->code_bytes;
  session->coded_pixels = session->code_bytes = 0;
  return is_paced(server.options.pace) ? code_ns(server.options.encode, pixels, bytes) : 0;
}

// Codes finished rows and charges the time.
void code_chunks(Server* server, Session* session) {
  const Times start = times_of(server);
  const std::uint64_t pixels = session->coded_pixels;
  send_chunks(session);
  CHECK_GE(session->coded_pixels, pixels);
  const std::uint64_t coded = session->coded_pixels - pixels;
  const std::uint64_t coding = take_coding_ns(*server, session);
  if (coding > 0) server->cpu_free_ns = now_ns(server) + coding;
  const Times end = times_of(server);
  const std::uint64_t sending = elapsed(start.now, end.now) + coding, cpu = elapsed(start.cpu, end.cpu) + coding;
  if (coded > 0) session->code_pixel_ns = static_cast<double>(sending) / static_cast<double>(coded);
  account_for(server, session, cpu, true);
  if (has_job(*session)) {
    session->job.took_ns += cpu;
  } else {
    session->ended_took_ns += cpu;
    session->ended_sent_ns += cpu;
  }
}

// Returns whether to code finished rows in parallel with the next slice, which delays them until its end but leaves no
// thread idle. Not the first ones, for which the link waits. An emulated CPU has one core.
bool pays_to_wait(const Server& server, const Session& session, std::uint64_t slice_ns) {
  if (!server.workers || is_paced(server.options.pace) || server.options.helpers) return false;
  const FrameJob& job = session.job;
  if (!has_chunk(session) || job.rows_sent == 0 || !has_rows(job.traced)) return false;
  const std::uint64_t pixels = std::uint64_t(job.rows_traced - job.rows_sent) * session.shape.width;
  return static_cast<double>(slice_ns) <= kBesideSlices * session.code_pixel_ns * static_cast<double>(pixels);
}

// Codes rows that wait for a slice of their session, unless it comes next.
void code_waiting(Server* server, const Session* next) {
  for (Session& session : server->sessions)
    if (&session != next && has_job(session) && session.job.codes_beside) code_chunks(server, &session);
}

// Handles messages, queues rows that waited for room, prepares a frame or traces a part of it.
void begin_work(Server* server, int index) {
  CHECK_LT(server->work.session, 0);
  CHECK(index >= 0 && index < static_cast<int>(server->sessions.size()));
  Session* session = &server->sessions[static_cast<std::size_t>(index)];
  Work* work = &server->work;
  *work = Work();
  work->session = index;
  work->address = session->address;
  work->job_number = session->job_number;
  work->is_job = !(in_turn(*server) && (wants_messages(*session) || has_chunk(*session)));
  code_waiting(server, work->is_job ? session : nullptr);
  const Times begun = times_of(server);
  const std::uint64_t start = begun.now, waited_since = session->waiting_since_ns;
  if (!work->is_job && wants_messages(*session)) {
    std::uint64_t queued = queued_in_all(session->messages);
    work->message_count = take_messages(server, session);
    work->byte_count = queued_in_all(session->messages) - queued;
  } else if (!work->is_job) {
    send_chunks(session);
  } else {
    WireError code;
    const ServerOptions& o = server->options;
    work->is_build = session->job.stage <= JobStage::own_exposure;
    JobTools tools = {o.thread_count, server->workers, o.coherence, o.helpers};
    Status status = step_job(session, tools, slice_ns(*server, *session), &work->slice, &code);
    if (!status.ok) {
      std::uint32_t frame = session->job.request.frame;
      drop_job(session);
      refuse(server, session, code, frame, status.message);
    }
  }

  const Times ended = times_of(server);
  std::uint64_t now = ended.now, took = elapsed(start, now);
  work->begin_ns = start;
  work->end_ns = now;
  work->cpu_ns = elapsed(begun.cpu, ended.cpu);
  if (is_paced(server->options.pace)) {
    took = work_ns(*server, *session, *work, took) + take_coding_ns(*server, session);
    // Work that already waited when the CPU became free began at that moment.
    if (work->is_job && waited_since < server->cpu_free_ns && server->cpu_free_ns < start)
      work->begin_ns = server->cpu_free_ns;
    if (server->cpu_free_ns > start) work->begin_ns = server->cpu_free_ns;  // it was coding rows
    if (work->begin_ns + took > now) work->end_ns = work->begin_ns + took;
    server->cpu_free_ns = work->end_ns;
    work->cpu_ns = elapsed(work->begin_ns, work->end_ns);
  }
  work->timer = platform::link_timer(now, work->end_ns - now);
}

void end_work(Server* server) {
  CHECK_GE(server->work.session, 0);
  Work* work = &server->work;
  Session* session = &server->sessions[static_cast<std::size_t>(work->session)];
  work->session = -1;
  std::uint64_t took = elapsed(work->begin_ns, work->end_ns);
  bool goes_on = work->is_job && has_job(*session) && session->job_number == work->job_number;
  bool is_job = work->is_job && session->address == work->address;
  account_for(server, session, work->cpu_ns, is_job);
  if (is_job)
    (goes_on ? session->job.took_ns : session->ended_took_ns) += work->cpu_ns;  // of an abandoned frame: wasted
  if (!goes_on) return;
  if (work->is_build) session->job.build_ns += work->cpu_ns;
  if (work->slice.is_preparation) session->job.prepare_ns = took;
  if (work->slice.pixel_count > 0) end_slice(session, work->slice, took);
  session->waiting_since_ns = work->end_ns;
  session->job.codes_beside = pays_to_wait(*server, *session, took);
  if (!session->job.codes_beside) code_chunks(server, session);
  if (session->pixel_ps) server->pixel_ps = session->pixel_ps;
}

}  // namespace

void account_for(Server* server, Session* session, std::uint64_t took, bool is_job) {
  if (session->address < 0) return;
  CHECK_LT(session->address, static_cast<int>(server->addresses.size()));
  Address* address = &server->addresses[static_cast<std::size_t>(session->address)];
  charge(&server->lanes, &address->account, took);
  charge(&address->lanes, &session->account, took);
  for (Account* account : {&address->account, &session->account}) {
    if (is_job)
      account->job_ns += took;
    else
      owe_messages(account, took);
  }
}

std::uint16_t newcomer_price(const Server& server, std::uint64_t key) {
  for (const Address& address : server.addresses)
    if (address.key == key)
      return price_of(crowding(server.lanes, address.account), crowding(address.lanes, Account()));
  return price_of(crowding(server.lanes, Account()), 1);
}

void refuse(Server* server, Session* session, WireError code, std::uint32_t frame, const char* reason) {
  send_error(session, code, frame);
  log_line(&server->log, now_ns(server), "%s: frame %u refused: %s", session->name, frame, reason);
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
