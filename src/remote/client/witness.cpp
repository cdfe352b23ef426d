// Checks without the scene: the device cannot render, but can request a row from another server.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// The device stops waiting for an answer after kLateAnswers times the usual time, but not before kAnswerNsMin. Chosen:
// answers within one or two display frames are never late, however fast the usual ones; and four times is twice what
// smooth.cpp treats as an outlier.
constexpr double kLateAnswers = 4;
constexpr double kAnswerNsMin = 50e6;

std::size_t row_bytes(const Client& client) {
  return std::size_t(client.settings.width) * pixel_bytes(client.options.format);
}

// Servers ready to be asked, in random order.
std::uint32_t ready_servers(Client* client, std::uint32_t servers[kServerCountMax]) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < client->server_count; ++i)
    if (client->servers[i].overture.phase == ServerPhase::ready) servers[count++] = i;
  for (std::uint32_t i = 0; i < count; ++i)
    std::swap(servers[i], servers[i + random_below(&client->verifier.random, count - i)]);
  return count;
}

std::uint32_t random_row_of(Client* client, std::uint32_t server, std::uint32_t row_count) {
  std::uint32_t left = random_below(&client->verifier.random, row_count), row = 0;
  for (;; ++row) {
    CHECK_LT(row, client->picture.merge.rows.count);
    if (client->picture.merge.rows[row].state == RowState::server && client->picture.merge.rows[row].server == server &&
        left-- == 0)
      return row;
  }
}

void ask_witness(Client* client, std::uint32_t witness, std::uint32_t row) {
  CHECK(witness < client->server_count && row < client->settings.height);
  RemoteServer* server = &client->servers[witness];
  server->witness.frame_before = server->rows.frame;
  server->witness.frame_before.open = false;  // its unsent rows were left to a later request
  request_rows(client, server, row, row + 1);
  if (server->overture.phase != ServerPhase::ready) return;  // just lost
  server->witness.is_asked = true;
  client->verifier.is_asking = true;
}

bool is_late(const Client& client) {
  const Verifier& v = client.verifier;
  double ns = static_cast<double>(client_now_ns(client) - v.ask_ns);
  double usual = is_known(v.check_ns) ? static_cast<double>(v.check_ns.value) : 0;
  return ns > std::max(kAnswerNsMin, kLateAnswers * usual);
}

// True if no answers are due.
bool answers_are_here(Client* client) {
  CHECK(client->verifier.is_asking);
  Verifier* v = &client->verifier;
  bool late = is_late(*client);
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    const RemoteServer& server = client->servers[i];
    if (server.witness.is_asked && server.rows.frame.open && server.overture.phase == ServerPhase::ready && !late)
      return false;
  }
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (!server->witness.is_asked) continue;
    server->witness.is_asked = false;
    if (v->dispute.open && v->dispute.judge == i) v->dispute.judged = server->rows.frame.rows_come > 0;
    std::uint64_t bytes = server->rows.frame.bytes, rows_bytes = server->rows.frame.row_bytes;
    server->rows.frame = server->witness.frame_before;
    server->rows.frame.bytes = bytes, server->rows.frame.row_bytes = rows_bytes;
  }
  smooth(&v->check_ns, static_cast<double>(client_now_ns(*client) - v->ask_ns));
  v->is_asking = false;
  return true;
}

void count_row(Client* client, std::uint32_t server) {
  ServerChecks* checks = &client->servers[server].checks;
  ++checks->checked;
  ++client->share.checked[server];
  SpotCheck odds;
  odds.rows = count_rows(client->picture.merge, server), odds.width = 1, odds.wrong_rows = 1, odds.pixels = 1;
  checks->caught_row_last = catch_probability(odds);
  CHECK(checks->caught_row_last >= 0 && checks->caught_row_last <= 1);
  checks->caught_row = either_probability(checks->caught_row, checks->caught_row_last);
}

// Has a row of each server compared by the next server in the ring.
void ask_all(Client* client) {
  std::uint32_t order[kServerCountMax], count = ready_servers(client, order);
  if (count < 2) return;
  client->verifier.ask_ns = client_now_ns(*client);
  for (std::uint32_t k = 0; k < count; ++k) {
    std::uint32_t server = order[k], witness = order[(k + 1) % count], rows = count_rows(client->picture.merge, server);
    if (rows > 0) ask_witness(client, witness, random_row_of(client, server, rows));
  }
}

// True if a round of checks is due in this frame.
bool is_due(Client* client) {
  Verifier* v = &client->verifier;
  bool again = v->again;
  v->again = false;
  if (v->frame == client->frame.request.frame) return again;
  v->frame = client->frame.request.frame;
  if (v->check_count > 0 || !is_known(v->check_ns)) return true;
  double frame_ns = static_cast<double>(client_now_ns(*client) - client->frame.begin_ns);
  return due_checks(&v->schedule, kCheckShare * frame_ns / static_cast<double>(v->check_ns.value), &v->random) > 0;
}

// Asks a server outside the dispute; returns false if there is none.
bool ask_judge(Client* client) {
  Dispute* d = &client->verifier.dispute;
  std::uint32_t order[kServerCountMax], count = ready_servers(client, order);
  for (std::uint32_t k = 0; k < count; ++k) {
    if (d->asked >> order[k] & 1) continue;
    d->judge = order[k];
    d->asked |= 1u << order[k];
    client->verifier.ask_ns = client_now_ns(*client);
    ask_witness(client, d->judge, d->row);
    if (client->verifier.is_asking) return true;
  }
  return false;
}

void tell_dispute(Client* client) {
  Verifier* v = &client->verifier;
  if (!v->disputed && client->options.log) {
    char line[400];
    std::snprintf(line, sizeof line,
                  "servers %s and %s sent different pixels for row %u of frame %u, and without the scene this device "
                  "cannot tell which is right: add a third --server, or enough --memory for the scene",
                  client->servers[v->dispute.server].address.text, client->servers[v->dispute.other].address.text,
                  v->dispute.row, client->frame.request.frame);
    client->options.log(client->options.log_context, line);
  }
  v->disputed = true;
}

// Compares two servers' versions of a row. Both may be off by a tolerance.
bool rows_agree(const Client& client, const std::uint8_t* a, const std::uint8_t* b) {
  return pixels_close(client.options.format, a, b, client.settings.width, 2 * pixel_tolerance(client));
}

// Drops the server that differs from the judge, if exactly one does.
void judge(Client* client) {
  Verifier* v = &client->verifier;
  Dispute* d = &v->dispute;
  CHECK_LT(d->judge, client->server_count);
  const std::uint8_t* third = picture_row(client->servers[d->judge].decoder->state, d->row);
  bool agrees[2];
  for (int k = 0; k < 2; ++k) agrees[k] = rows_agree(*client, v->versions[k].data, third);
  if (agrees[0] == agrees[1]) return;
  char proof[160];
  std::snprintf(proof, sizeof proof, "frame %u, row %u differs from two other servers", client->frame.request.frame,
                d->row);
  drop_liar(client, &client->servers[agrees[0] ? d->other : d->server], proof);
  d->open = false;
  v->again = true;
}

// Opens a dispute between two servers. One at a time: later frames show further differences.
void open_dispute(Client* client, std::uint32_t row, std::uint32_t server, std::uint32_t other) {
  CHECK(server != other);
  Verifier* v = &client->verifier;
  if (v->dispute.open) return;
  v->dispute = Dispute();
  v->dispute.open = true;
  v->dispute.row = row, v->dispute.server = server, v->dispute.other = other;
  v->dispute.asked = 1u << server | 1u << other;
  std::memcpy(v->versions[0].data, merged_row(*client, row), row_bytes(*client));
  std::memcpy(v->versions[1].data, picture_row(client->servers[other].decoder->state, row), row_bytes(*client));
}

}  // namespace

void compare_with_others(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end) {
  if (client->verifier.check_count == 0) return;
  for (std::uint32_t row = row_begin; row < row_end; ++row) {
    const MergeRow& merged = client->picture.merge.rows[row];
    if (merged.state != RowState::server || merged.server == index_of(*client, server)) continue;
    if (!rows_agree(*client, merged_row(*client, row), picture_row(server->decoder->state, row)))
      open_dispute(client, row, merged.server, index_of(*client, server));
    else if (server->witness.is_asked)
      count_row(client, merged.server);
  }
}

bool is_witnessed(Client* client) {
  Verifier* v = &client->verifier;
  if (v->is_asking) {
    if (!answers_are_here(client)) return false;
    if (v->dispute.open && v->dispute.judged) judge(client);
  } else if (is_due(client)) {
    ask_all(client);
  }
  if (!has_all_rows(*client) || v->is_asking) return false;
  if (v->dispute.open && ask_judge(client)) return false;
  if (v->dispute.open) tell_dispute(client);
  v->dispute.open = false;
  if (v->again) return false;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    ServerChecks* checks = &client->servers[i].checks;
    checks->rows += count_rows(client->picture.merge, i);
    if (client->share.checked[i] == 0) checks->caught_row_last = 0;
  }
  return true;
}

}  // namespace pocketray
