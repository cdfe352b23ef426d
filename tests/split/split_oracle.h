// Random split problems, and the best split by exhaustive search.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "base/rng.h"
#include "split/split.h"

namespace pocketray {

// A problem with its own tables.
struct GeneratedProblem {
  SplitProblem problem;
  std::vector<std::unique_ptr<std::vector<std::uint64_t>>> tables;
};

template <class Entry>
RowTable make_table(GeneratedProblem* g, Entry entry) {
  auto table = std::make_unique<std::vector<std::uint64_t>>(g->problem.row_count + 1);
  for (std::uint32_t r = 0; r < g->problem.row_count; ++r) (*table)[r + 1] = (*table)[r] + entry(r);
  g->tables.push_back(std::move(table));
  return g->tables.back()->data();
}

// Equal, random, rising, or mostly zero rows, up to `max` each.
inline RowTable random_table(GeneratedProblem* g, Rng* rng, std::uint64_t max) {
  std::uint32_t kind = next_u32(rng) % 4;
  std::uint64_t level = 1 + static_cast<std::uint64_t>(next_double(rng) * static_cast<double>(max));
  return make_table(g, [&](std::uint32_t r) -> std::uint64_t {
    if (kind == 0) return level;
    if (kind == 1) return next_u32(rng) % level;
    if (kind == 2) return level * r / g->problem.row_count;
    return next_u32(rng) % 8 ? 0 : level;
  });
}

// `scale`: approximate cost of a row on the device. Small values give many equally good splits.
inline std::unique_ptr<GeneratedProblem> random_problem(std::uint32_t row_count, std::uint32_t server_count,
                                                        std::uint64_t scale, Rng* rng) {
  auto g = std::make_unique<GeneratedProblem>();
  SplitProblem* p = &g->problem;
  p->row_count = row_count, p->server_count = server_count;
  auto up_to = [&](std::uint64_t max) { return next_u32(rng) % (max + 1); };
  p->device_ns = random_table(g.get(), rng, scale);
  p->unpack_ns = random_table(g.get(), rng, scale / 16 + 1);
  p->link_ns = random_table(g.get(), rng, scale / 4 + 1);
  p->device_cost = random_table(g.get(), rng, scale);
  p->device_start_ns = up_to(scale * 4), p->link_start_ns = up_to(scale);
  if (next_u32(rng) % 4 == 0) p->device_least_ns = up_to(scale * row_count);
  for (std::uint32_t i = 0; i < server_count; ++i) {
    ServerTables* s = &p->servers[i];
    s->usable = next_u32(rng) % 8 != 0;
    s->render_ns = random_table(g.get(), rng, scale / (1 + up_to(8)) + 1);
    s->transfer_ns = random_table(g.get(), rng, scale / (1 + up_to(8)) + 1);
    s->cost = random_table(g.get(), rng, scale * 2);
    s->start_ns = up_to(scale * 8);
    s->chunk_rows = 1 + static_cast<std::uint32_t>(up_to(20));
    s->chunk_row_ns = up_to(scale / 8);
  }
  return g;
}

// The longest of the servers' bands.
inline std::uint64_t slowest_band(const SplitProblem& p, const std::uint32_t* boundary) {
  std::uint64_t slowest = 0;
  for (std::uint32_t i = 0; i < p.server_count; ++i) {
    std::uint32_t begin = boundary[i], end = boundary[i + 1];
    const ServerTables& s = p.servers[i];
    if (begin == end) continue;
    std::uint64_t render = s.render_ns[end] - s.render_ns[begin], send = s.transfer_ns[end] - s.transfer_ns[begin];
    slowest =
        std::max(slowest, s.start_ns + std::min(end - begin, s.chunk_rows) * s.chunk_row_ns + std::max(render, send));
  }
  return slowest;
}

// The definition of a split's time and cost in split.h, implemented again. Returns the time; sets *cost.
inline std::uint64_t judge(const SplitProblem& p, const std::uint32_t* boundary, std::uint64_t* cost) {
  auto sum = [](RowTable table, std::uint32_t begin, std::uint32_t end) { return table[end] - table[begin]; };
  std::uint32_t own = boundary[0], all = p.row_count;
  std::uint64_t time = sum(p.device_ns, 0, own) + sum(p.unpack_ns, own, all) + (own > 0 ? p.device_start_ns : 0);
  if (own > 0) time = std::max(time, p.device_least_ns);
  if (own < all) time = std::max(time, p.link_start_ns + sum(p.link_ns, own, all));
  *cost = sum(p.device_cost, 0, own);
  for (std::uint32_t i = 0; i < p.server_count; ++i) {
    std::uint32_t begin = boundary[i], end = boundary[i + 1];
    if (begin == end) continue;
    const ServerTables& s = p.servers[i];
    if (!s.usable) return ~std::uint64_t(0);
    *cost += sum(s.cost, begin, end);
  }
  return std::max(time, slowest_band(p, boundary));
}

struct Best {
  std::uint64_t objective = ~std::uint64_t(0), cost = ~std::uint64_t(0);
  std::uint64_t slowest_band = ~std::uint64_t(0);  // least among equally good splits
  std::uint64_t least_cost = ~std::uint64_t(0);    // of any split, whatever the cap
};

// Searches all splits.
inline Best best_of_all(const SplitProblem& p) {
  Best best;
  std::uint32_t boundary[kServerCountMax + 1];
  auto visit = [&](auto&& self, std::uint32_t index, std::uint32_t from) -> void {
    if (index == p.server_count) {
      boundary[index] = p.row_count;
      std::uint64_t cost, time = judge(p, boundary, &cost);
      if (time == ~std::uint64_t(0)) return;
      best.least_cost = std::min(best.least_cost, cost);
      if (cost > p.cost_cap) return;
      std::uint64_t objective = time + (p.weigh_cost ? cost : 0);
      std::uint64_t slowest = slowest_band(p, boundary);
      if (std::tie(objective, cost, slowest) < std::tie(best.objective, best.cost, best.slowest_band))
        best.objective = objective, best.cost = cost, best.slowest_band = slowest;
      return;
    }
    for (boundary[index] = from; boundary[index] <= p.row_count; ++boundary[index])
      self(self, index + 1, boundary[index]);
  };
  visit(visit, 0, 0);
  return best;
}

// A workspace in its own memory.
struct OwnWorkspace {
  std::vector<std::uint8_t> block;
  SplitWorkspace workspace;
  OwnWorkspace(std::uint32_t row_count, std::uint32_t server_count)
      : block(split_need(row_count, server_count) + kArenaAlignment) {
    Arena arena = make_arena("split", block.data(), block.size());
    workspace = make_split_workspace(row_count, server_count, &arena);
  }
};

}  // namespace pocketray
