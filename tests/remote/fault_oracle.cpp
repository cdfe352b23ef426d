#include "fault_oracle.h"

#include <algorithm>

#include "split/split_oracle.h"

namespace pocketray {

double best_frame_ns(const FaultPlan& plan, const Client& client) {
  GeneratedProblem g;
  SplitProblem* p = &g.problem;
  p->row_count = plan.height, p->server_count = plan.server_count;
  double line_ns = plan.line.bytes_per_second > 0 ? 1e9 / static_cast<double>(plan.line.bytes_per_second) : 0;
  double bytes_sum = 0;
  auto bytes = [&](std::uint32_t row) { return static_cast<double>(client.plan.model.rows[row].bytes.value); };
  auto by_bytes = [&](double ns) {
    return make_table(&g, [&](std::uint32_t row) { return static_cast<std::uint64_t>(bytes(row) * ns); });
  };
  auto by_cost = [&](double ns_per_pixel) {
    double row_ns = ns_per_pixel * plan.width;
    return make_table(&g, [&](std::uint32_t row) {
      return static_cast<std::uint64_t>(row_ns * static_cast<double>(plan.row_costs[row]));
    });
  };
  for (std::uint32_t row = 0; row < plan.height; ++row) bytes_sum += bytes(row);
  p->device_ns = by_cost(plan.device_ns);
  p->unpack_ns = by_bytes(plan.read_ns);
  p->link_ns = by_bytes(line_ns);
  p->device_cost = by_bytes(0);
  std::uint64_t start_ns = 2 * plan.line.latency_ns + plan.line.jitter_ns;
  p->link_start_ns = start_ns;
  for (std::uint32_t i = 0; i < plan.server_count; ++i) {
    ServerTables* t = &p->servers[i];
    t->usable = client.servers[i].overture.phase == ServerPhase::ready;
    t->render_ns = by_cost(plan.server_ns[i]);
    t->transfer_ns = by_bytes(line_ns);
    t->cost = by_bytes(1);
    t->start_ns = start_ns;
    t->chunk_rows = std::min(kChunkRowsMin, plan.height);
    t->chunk_row_ns =
        static_cast<std::uint64_t>(std::min(plan.server_ns[i] * plan.width, bytes_sum / plan.height * line_ns));
  }
  OwnWorkspace own(plan.height, plan.server_count);
  return static_cast<double>(find_split(*p, &own.workspace).time_ns);
}

}  // namespace pocketray
