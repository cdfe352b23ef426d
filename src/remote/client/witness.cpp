// Checks of a device without the scene: it can render nothing itself, but it can ask another server for the same row.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "remote/client/parts.h"

namespace pocketray {
namespace {

// An answer that takes longer than so many usual ones, and at least this time, is not waited for.
constexpr double kLateAnswers = 4;
constexpr double kAnswerNsMin = 50e6;

std::size_t row_bytes(const Client& c) { return std::size_t(c.settings.width) * pixel_bytes(c.options.format); }

// Servers that can be asked, in a random order.
std::uint32_t ready_servers(Client* c, std::uint32_t servers[kServerCountMax]) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < c->server_count; ++i)
    if (c->servers[i].phase == ServerPhase::ready) servers[count++] = i;
  for (std::uint32_t i = 0; i < count; ++i)
    std::swap(servers[i], servers[i + random_below(&c->verifier.random, count - i)]);
  return count;
}

std::uint32_t random_row_of(Client* c, std::uint32_t server, std::uint32_t row_count) {
  std::uint32_t left = random_below(&c->verifier.random, row_count), row = 0;
  for (;; ++row)
    if (c->merge.rows[row].state == RowState::server && c->merge.rows[row].server == server && left-- == 0) return row;
}

void ask_witness(Client* c, std::uint32_t witness, std::uint32_t row) {
  RemoteServer* s = &c->servers[witness];
  s->frame_before = s->frame;
  s->frame_before.open = false;  // rows that it has not sent are a later request's
  request_rows(c, s, row, row + 1);
  if (s->phase != ServerPhase::ready) return;  // lost just now
  s->is_witness = true;
  c->verifier.is_asking = true;
}

bool is_late(const Client& c) {
  const Verifier& v = c.verifier;
  double ns = static_cast<double>(client_now_ns(c) - v.ask_ns);
  double usual = is_known(v.check_ns) ? static_cast<double>(v.check_ns.value) : 0;
  return ns > std::max(kAnswerNsMin, kLateAnswers * usual);
}

// Whether nobody is waited for any more.
bool answers_are_here(Client* c) {
  Verifier* v = &c->verifier;
  bool late = is_late(*c);
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    const RemoteServer& s = c->servers[i];
    if (s.is_witness && s.frame.open && s.phase == ServerPhase::ready && !late) return false;
  }
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    if (!s->is_witness) continue;
    s->is_witness = false;
    if (v->dispute.open && v->dispute.judge == i) v->dispute.judged = s->frame.rows_come > 0;
    std::uint64_t bytes = s->frame.bytes, rows_bytes = s->frame.row_bytes;
    s->frame = s->frame_before;
    s->frame.bytes = bytes, s->frame.row_bytes = rows_bytes;
  }
  smooth(&v->check_ns, static_cast<double>(client_now_ns(*c) - v->ask_ns));
  v->is_asking = false;
  return true;
}

void count_row(Client* c, std::uint32_t server) {
  ServerChecks* checks = &c->servers[server].checks;
  ++checks->checked;
  ++c->share.checked[server];
  SpotCheck odds;
  odds.rows = count_rows(c->merge, server), odds.width = 1, odds.wrong_rows = 1, odds.pixels = 1;
  checks->caught_row_last = catch_probability(odds);
  checks->caught_row = either_probability(checks->caught_row, checks->caught_row_last);
}

// Each server that has sent rows has one of them compared, by the next in a circle.
void ask_all(Client* c) {
  std::uint32_t order[kServerCountMax], count = ready_servers(c, order);
  if (count < 2) return;
  c->verifier.ask_ns = client_now_ns(*c);
  for (std::uint32_t k = 0; k < count; ++k) {
    std::uint32_t server = order[k], witness = order[(k + 1) % count], rows = count_rows(c->merge, server);
    if (rows > 0) ask_witness(c, witness, random_row_of(c, server, rows));
  }
}

// As many rounds as are due, in this frame 0 or 1.
bool is_due(Client* c) {
  Verifier* v = &c->verifier;
  bool again = v->again;
  v->again = false;
  if (v->frame == c->request.frame) return again;
  v->frame = c->request.frame;
  if (v->check_count > 0 || !is_known(v->check_ns)) return true;
  double frame_ns = static_cast<double>(client_now_ns(*c) - c->begin_ns);
  return due_checks(&v->schedule, kCheckShare * frame_ns / static_cast<double>(v->check_ns.value), &v->random) > 0;
}

// Asks somebody who has no part in it; false: there is nobody.
bool ask_judge(Client* c) {
  Dispute* d = &c->verifier.dispute;
  std::uint32_t order[kServerCountMax], count = ready_servers(c, order);
  for (std::uint32_t k = 0; k < count; ++k) {
    if (d->asked >> order[k] & 1) continue;
    d->judge = order[k];
    d->asked |= 1u << order[k];
    c->verifier.ask_ns = client_now_ns(*c);
    ask_witness(c, d->judge, d->row);
    if (c->verifier.is_asking) return true;
  }
  return false;
}

void tell_dispute(Client* c) {
  Verifier* v = &c->verifier;
  if (!v->disputed && c->options.log) {
    char line[400];
    std::snprintf(
        line, sizeof line,
        "servers %s and %s send different pixels for row %u of frame %u: without the scene this device cannot "
        "tell which are right; name a third server, or give it the --memory for the scene",
        c->servers[v->dispute.server].address.text, c->servers[v->dispute.other].address.text, v->dispute.row,
        c->request.frame);
    c->options.log(c->options.log_context, line);
  }
  v->disputed = true;
}

// Drops the one of the two that differs from the judge, where just one does.
void judge(Client* c) {
  Verifier* v = &c->verifier;
  Dispute* d = &v->dispute;
  const std::uint8_t* third = picture_row(c->servers[d->judge].decoder->state, d->row);
  bool agrees[2];
  for (int k = 0; k < 2; ++k) agrees[k] = std::memcmp(v->versions[k].data, third, row_bytes(*c)) == 0;
  if (agrees[0] == agrees[1]) return;
  char proof[160];
  std::snprintf(proof, sizeof proof, "frame %u, row %u differs from what two others send", c->request.frame, d->row);
  drop_liar(c, &c->servers[agrees[0] ? d->other : d->server], proof);
  d->open = false;
  v->again = true;
}

// Two servers have sent different rows. One dispute at a time: what else they differ in is told by the next frames.
void open_dispute(Client* c, std::uint32_t row, std::uint32_t server, std::uint32_t other) {
  Verifier* v = &c->verifier;
  if (v->dispute.open) return;
  v->dispute = Dispute();
  v->dispute.open = true;
  v->dispute.row = row, v->dispute.server = server, v->dispute.other = other;
  v->dispute.asked = 1u << server | 1u << other;
  std::memcpy(v->versions[0].data, shared_row(*c, row), row_bytes(*c));
  std::memcpy(v->versions[1].data, picture_row(c->servers[other].decoder->state, row), row_bytes(*c));
}

}  // namespace

void compare_with_others(Client* c, RemoteServer* s, std::uint32_t row_begin, std::uint32_t row_end) {
  if (c->verifier.check_count == 0) return;
  for (std::uint32_t row = row_begin; row < row_end; ++row) {
    const MergeRow& merged = c->merge.rows[row];
    if (merged.state != RowState::server || merged.server == index_of(*c, s)) continue;
    if (std::memcmp(shared_row(*c, row), picture_row(s->decoder->state, row), row_bytes(*c)) != 0)
      open_dispute(c, row, merged.server, index_of(*c, s));
    else if (s->is_witness)
      count_row(c, merged.server);
  }
}

bool is_witnessed(Client* c) {
  Verifier* v = &c->verifier;
  if (v->is_asking) {
    if (!answers_are_here(c)) return false;
    if (v->dispute.open && v->dispute.judged) judge(c);
  } else if (is_due(c)) {
    ask_all(c);
  }
  if (!has_all_rows(*c) || v->is_asking) return false;
  if (v->dispute.open && ask_judge(c)) return false;
  if (v->dispute.open) tell_dispute(c);
  v->dispute.open = false;
  if (v->again) return false;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    ServerChecks* checks = &c->servers[i].checks;
    checks->rows += count_rows(c->merge, i);
    if (c->share.checked[i] == 0) checks->caught_row_last = 0;
  }
  return true;
}

}  // namespace pocketray
