// A device without the scene: servers render every row, and rows that one fails to deliver are requested from another.
#include <algorithm>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Chosen; ClientOptions::connect_timeout_ns is 3 s.
constexpr std::uint64_t kCutOffNs = 5'000'000'000;  // without rows; longer than connecting may take
// A server silent for the time of kSilentChunks of its chunks counts as stopped, but not before kSilentNsMin, longer
// than the pauses of a busy system. Chosen: with fewer chunks, rows that are merely late would be requested twice; with
// more, they would be missing for longer.
constexpr double kSilentChunks = 4, kSilentNsMin = 30e6;

// Number of servers asked for the row.
std::uint32_t asked_count(const Client& client, std::uint32_t row) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const ServerFrame& f = client.servers[i].rows.frame;
    count += f.open && f.row_begin <= row && row < f.row_end;
  }
  return count;
}

// The longest run of missing rows in [begin, end) requested from exactly `count` servers.
RowRange longest_run(const Client& client, std::uint32_t begin, std::uint32_t end, std::uint32_t count) {
  CHECK(begin <= end && end <= client.picture.merge.rows.count);
  RowRange best = {0, 0}, run = {begin, begin};
  for (std::uint32_t row = begin; row < end; ++row) {
    if (client.picture.merge.rows[row].state != RowState::missing || asked_count(client, row) != count) {
      run = {row + 1, row + 1};
      continue;
    }
    run.end = row + 1;
    if (run.end - run.begin > best.end - best.begin) best = run;
  }
  return best;
}

bool is_idle(const RemoteServer& server) {
  return server.overture.phase == ServerPhase::ready && !server.rows.frame.open;
}

// Rows per time; equal for all while unknown.
double speed_of(const Client& client, const RemoteServer& server) {
  double sum = 0, count = 0;
  for (std::uint32_t i = 0; i < client.server_count; ++i)
    if (is_known(client.servers[i].rows.row_ns))
      sum += 1 / static_cast<double>(client.servers[i].rows.row_ns.value), ++count;
  if (is_known(server.rows.row_ns)) return 1 / static_cast<double>(server.rows.row_ns.value);
  return count > 0 ? sum / count : 1;
}

// Divides the run among idle servers by their speed.
void divide(Client* client, const RowRange& run) {
  double speed_sum = 0, so_far = 0, rows = run.end - run.begin;
  for (std::uint32_t i = 0; i < client->server_count; ++i)
    if (is_idle(client->servers[i])) speed_sum += speed_of(*client, client->servers[i]);
  CHECK_GT(speed_sum, 0);  // some server is idle
  std::uint32_t begin = run.begin;
  for (std::uint32_t i = 0; i < client->server_count && begin < run.end; ++i) {
    RemoteServer* server = &client->servers[i];
    if (!is_idle(*server)) continue;
    so_far += speed_of(*client, *server);
    std::uint32_t end = run.begin + static_cast<std::uint32_t>(rows * std::min(1.0, so_far / speed_sum) + 0.5);
    want_coarse(client, client->share.measured_ns);
    if (end > begin) ask_for_rows(client, server, begin, end);
    client->frame.request.coarse_first = false;
    begin = end;
  }
}

// Returns the rows requested only from this server that another should render: all if it has fallen silent, otherwise
// the upper half, which it would send last.
RowRange rows_to_spare(const Client& client, const RemoteServer& server) {
  RowRange run = longest_run(client, server.rows.frame.row_begin, server.rows.frame.row_end, 1);
  double silent =
      static_cast<double>(client_now_ns(client) - std::max(server.rows.frame.asked_ns, server.rows.frame.heard_ns));
  double chunk_ns = static_cast<double>(server.rows.row_ns.value) * kChunkRowsEven;
  if (silent > std::max(kSilentNsMin, kSilentChunks * chunk_ns)) return run;
  std::uint32_t rows = run.end - run.begin;
  if (rows < 2 * kChunkRowsEven || !is_known(server.rows.row_ns)) return {0, 0};
  return {run.begin, run.begin + rows / 2};
}

void take_over(Client* client, RemoteServer* idle) {
  CHECK(is_idle(*idle));
  RowRange best = {0, 0};
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    if (!client->servers[i].rows.frame.open) continue;
    RowRange run = rows_to_spare(*client, client->servers[i]);
    if (run.end - run.begin > best.end - best.begin) best = run;
  }
  if (best.begin < best.end) ask_for_rows(client, idle, best.begin, best.end);
}

}  // namespace

void ask_idle_servers(Client* client) {
  bool idle = false;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (server->overture.phase == ServerPhase::probing)
      server_is_ready(client, server);  // its speed shows as rows come
    idle = idle || is_idle(*server);
  }
  if (!idle || client->frame.complete) return;
  RowRange run = longest_run(*client, 0, client->settings.height, 0);
  if (run.begin < run.end) divide(client, run);
  for (std::uint32_t i = 0; i < client->server_count; ++i)
    if (is_idle(client->servers[i])) take_over(client, &client->servers[i]);
}

void learn_row_times(Client* client) {
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    const ServerFrame& f = server->rows.frame;
    if (f.asked_ns == 0 || server->overture.phase != ServerPhase::ready) continue;
    std::uint64_t end = f.rows_come > 0 && !f.open ? f.heard_ns : client_now_ns(*client);
    smooth(&server->rows.row_ns, static_cast<double>(end - f.asked_ns) / std::max(1u, f.rows_come));
  }
}

bool is_cut_off(const Client& client) {
  if (client.options.has_scene || client.frame.complete) return false;
  std::uint64_t now = client_now_ns(client), since = std::max(client.frame.begin_ns, client.frame.progress_ns);
  if (now < since + kCutOffNs) return false;
  if (now >= since + std::max(kCutOffNs, client.options.prepare_timeout_ns)) return true;
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    if (server.overture.phase == ServerPhase::ready && server.rows.frame.open && server.rows.frame.answers)
      return false;  // it is alive, just slow
  }
  return true;
}

}  // namespace pocketray
