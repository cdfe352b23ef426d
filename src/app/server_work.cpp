#include "app/server_state.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kSliceNs = 20'000'000;  // of the CPU, before another client may have its turn

std::uint64_t elapsed(std::uint64_t begin, std::uint64_t end) { return end > begin ? end - begin : 0; }

// The one of those with work that has used the CPU least; notes since when they wait. -1: there is none.
int choose_session(Server* server) {
  std::uint64_t now = now_ns(server);
  int chosen = -1;
  for (std::size_t i = 0; i < server->sessions.size(); ++i) {
    Session* s = &server->sessions[i];
    if (s->phase != SessionPhase::serving || !can_work(*s)) {
      s->waiting_since_ns = 0;
      continue;
    }
    if (s->waiting_since_ns == 0) s->waiting_since_ns = now;
    if (chosen < 0 || s->used_ns < server->sessions[static_cast<std::size_t>(chosen)].used_ns)
      chosen = static_cast<int>(i);
  }
  return chosen;
}

// Prepares the frame or traces a part of it.
void begin_work(Server* server, int index) {
  Session* s = &server->sessions[static_cast<std::size_t>(index)];
  if (server->used_floor_ns < s->used_ns) server->used_floor_ns = s->used_ns;
  Work* work = &server->work;
  work->session = index;
  work->job_number = s->job_number;
  std::uint64_t start = now_ns(server);
  WireError code;
  Status status;
  work->slice = {};
  if (s->job.prepared)
    work->slice = trace_slice(s, kSliceNs);
  else if (s->job.is_view_query)
    status = answer_view_query(s, server->options.thread_count, server->workers, &code);
  else
    status = prepare_job(s, server->options.thread_count, server->workers, &code);
  std::uint64_t now = now_ns(server), took = elapsed(start, now);
  if (!status.ok) {
    drop_job(s);
    refuse(server, s, code, s->job.request.frame, status.message);
  }

  work->begin_ns = start;
  work->end_ns = now;
  if (is_paced(server->options.pace)) {
    took = paced_ns(server->options.pace, work->slice.pixel_count, took);
    // Who waited already when the CPU became free was begun with at that moment.
    if (s->waiting_since_ns < server->cpu_free_ns && server->cpu_free_ns < start) work->begin_ns = server->cpu_free_ns;
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
  s->used_ns += took;
  if (!has_job(*s) || s->job_number != work->job_number) return;
  if (work->slice.pixel_count > 0) end_slice(s, work->slice, took, elapsed(s->waiting_since_ns, work->end_ns));
  s->waiting_since_ns = work->end_ns;
  send_chunks(s);
  if (s->pixel_ps) server->pixel_ps = s->pixel_ps;
}

}  // namespace

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
