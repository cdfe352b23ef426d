#include "remote/client/outlook.h"

#include <algorithm>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr double kNeverNs = 1e18;
// Measured, by `make split-table` (within 1.05 of the best fixed split on every device and link) and `make faults`
// (within 1.05 of the device alone).
constexpr double kCertainPart = 0.5;  // of a row's estimated time, since rows are measured several at a time
// Relative to a frame's predicted time, and to the device's time alone, after which it waits for no more rows.
constexpr double kLateFactor = 1.03;

// Time for what servers may still send of the current frame: they drop the rest of it between two chunks.
double chunk_ns(const Client& client) {
  double bytes = 0, longest = 0;
  for (const RowModel& row : client.plan.model.rows) bytes += static_cast<double>(row.bytes.value);
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    if (!server.rows.frame.open) continue;
    const double rows = std::min(server.rows.due_rows, kChunkRowsMax);
    longest = std::max(longest, rows * static_cast<double>(client.plan.model.servers[i].ns_per_byte.value));
  }
  return longest * bytes / client.settings.height;
}

// Time until a server's last row: its delay so far, once more, and then the rest at the predicted speed.
double server_left_ns(const Client& client, std::uint32_t i, double due_ns, std::uint64_t now_ns) {
  const ServerFrame& f = client.servers[i].rows.frame;
  CHECK_LT(f.row_begin, f.row_end);
  auto since = [](std::uint64_t at, std::uint64_t from) { return at > from ? static_cast<double>(at - from) : 0; };
  const double asked_ns = since(f.asked_ns, client.frame.begin_ns);
  const double whole_ns = std::max(0.0, due_ns - asked_ns);
  const double start_ns = std::min(whole_ns, static_cast<double>(client.plan.model.servers[i].start_ns.value));
  const double part = std::min(1.0, f.rows_come / static_cast<double>(f.row_end - f.row_begin));
  const double late_ns = since(now_ns, f.asked_ns) - start_ns - part * (whole_ns - start_ns);
  return std::max(0.0, late_ns) + (1 - part) * (whole_ns - start_ns);
}

// Time until the last server's last row; kNeverNs if none is to send anything.
double servers_left_ns(const Client& client, double due_ns) {
  double longest = 0;
  for (std::uint32_t i = 0; i < client.server_count; ++i)
    if (client.servers[i].rows.frame.open)
      longest = std::max(longest, server_left_ns(client, i, due_ns, client_now_ns(client)));
  return longest > 0 ? longest : kNeverNs;
}

}  // namespace

double rows_left_ns(const Client& client) {
  double known = 0, rows = 0;
  for (std::uint32_t r = 0; r < client.plan.model.rows.count; ++r) {
    const RowModel& row = client.plan.model.rows[r];
    if (client.picture.merge.rows[r].state == RowState::missing) known += device_row_ns(row);
    if (!is_done(client.picture.merge.rows[r])) rows += static_cast<double>(row.device_part);
  }
  return std::max(known, device_pixel_ns(client) * client.settings.width * rows);
}

double preparing_left_ns(const Client& client) {
  return client.frame.prepared ? 0 : static_cast<double>(client.plan.model.device_start_ns.value);
}

double decoding_left_ns(const Client& client) {
  double bytes = 0;
  for (std::uint32_t row = 0; row < client.plan.model.rows.count; ++row)
    if (!is_done(client.picture.merge.rows[row])) bytes += static_cast<double>(client.plan.model.rows[row].bytes.value);
  return bytes * static_cast<double>(client.plan.model.unpack_ns_per_byte.value);
}

double time_to_spare(const Client& client, double come_share) {
  auto is_measured = [](const RowModel& row) { return is_known(row.device_ns) && !row.guessed; };
  double seen = 0, seen_before = 0, others = 0, come = 0, unknown = 0;
  for (std::uint32_t r = 0; r < client.plan.model.rows.count; ++r) {
    const RowModel& row = client.plan.model.rows[r];
    if (!is_measured(row)) {
      if (!(row.device_ns_seen > 0)) ++unknown;
      continue;
    }
    double before = device_row_ns(row);
    if (row.device_ns_seen > 0)
      seen += static_cast<double>(row.device_ns_seen * row.device_part), seen_before += before;
    else
      others += before, come += client.picture.merge.rows[r].state == RowState::server ? before : 0;
  }
  // Rows rendered together share their mean, so a few of them can make a frame look slower than the last.
  double change = seen_before > 0 ? std::min(1.0, seen / seen_before) : 1;
  double alone =
      std::max(client.frame.device_ns, std::min(client.frame.device_ns + change * others, seen_before + others));
  alone += kCertainPart * unknown * device_pixel_ns(client) * client.settings.width;
  double idle = static_cast<double>(client_elapsed_ns(client) - client.frame.prepare_ns) - client.frame.device_ns;
  return kWaitShare * alone + come_share * change * come - idle;
}

bool is_worth_waiting(const Client& client) {
  double due = client.share.predicted_ns, elapsed = static_cast<double>(client_elapsed_ns(client)),
         row = preparing_left_ns(client) + device_pixel_ns(client) * client.settings.width;
  if (!client.frame.joined || elapsed >= std::max(kLateFactor * due, due + row)) return false;
  if (elapsed + row <= due && elapsed + row + decoding_left_ns(client) <= due) return false;
  bool any_guessed = std::any_of(client.plan.model.rows.begin(), client.plan.model.rows.end(),
                                 [](const RowModel& r) { return r.guessed; });
  double latest = kLateFactor * client.frame.alone_ns;
  return elapsed + preparing_left_ns(client) + rows_left_ns(client) <= latest &&
         (any_guessed || time_to_spare(client, kCertainPart) > 0);
}

FrameOutlook outlook_of(const Client& client) {
  FrameOutlook outlook;
  const FrameShare& share = client.share;
  const double due = share.predicted_ns > 0 ? share.predicted_ns : share.measured_ns;
  if (client.frame.complete || due <= 0) return outlook;
  const double shown_ns = client.coarse.shown ? std::min(due, static_cast<double>(client.coarse.ns)) : due;
  outlook.anew_ns = shown_ns + chunk_ns(client);
  const double elapsed = static_cast<double>(client_elapsed_ns(client));
  // Requests held until a link is measured would be held again; a frame with all rows is complete at the next poll.
  if (elapsed < due || client.frame.held || has_all_rows(client)) {
    outlook.left_ns = has_all_rows(client) ? 1 : std::max(1.0, due - elapsed);
    return outlook;
  }
  // They share the remaining rows.
  const double device_ns = preparing_left_ns(client) + rows_left_ns(client);
  const double own_ns = client.options.has_scene ? std::max(1.0, device_ns) : kNeverNs;
  outlook.left_ns = 1 / (1 / own_ns + 1 / servers_left_ns(client, due));
  return outlook;
}

}  // namespace pocketray
