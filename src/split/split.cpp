#include "split/split.h"

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kNever = ~std::uint64_t(0);

std::uint64_t larger(std::uint64_t a, std::uint64_t b) { return a > b ? a : b; }

// Time of the device, and of its incoming link, if the device renders the rows above `rows`.
std::uint64_t near_ns(const SplitProblem& p, std::uint32_t rows) {
  std::uint64_t device = p.device_ns[rows] + (p.unpack_ns[p.row_count] - p.unpack_ns[rows]);
  if (rows > 0) device = larger(device + p.device_start_ns, p.device_least_ns);
  std::uint64_t link = rows < p.row_count ? p.link_start_ns + (p.link_ns[p.row_count] - p.link_ns[rows]) : 0;
  return larger(device, link);
}

// Sets least[b] to the least cost of giving rows 0 … b − 1 to the device and the servers up to this one, with no band
// longer than time_ns. The first row at which a short enough band that ends at b may begin never decreases as b grows,
// so the cheapest band is a sliding minimum.
void extend_by_server(const SplitProblem& p, const ServerTables& server, std::uint64_t time_ns, SplitWorkspace* w,
                      std::uint16_t* band_begin) {
  std::uint16_t* window = w->window.data;  // candidate first rows; their costs ascend from `first` on
  std::uint32_t first = 0, last = 0;       // last: one past the end
  auto key = [&](std::uint32_t row) {
    return static_cast<std::int64_t>(w->least_before[row]) - static_cast<std::int64_t>(server.cost[row]);
  };
  for (std::uint32_t b = 0; b <= p.row_count; ++b) {
    if (w->least_before[b] != kNever) {
      while (last > first && key(window[last - 1]) >= key(b)) --last;
      window[last++] = static_cast<std::uint16_t>(b);
    }
    while (last > first && band_ns(server, window[first], b) > time_ns) ++first;
    w->least[b] =
        last > first ? w->least_before[window[first]] + (server.cost[b] - server.cost[window[first]]) : kNever;
    band_begin[b] = last > first ? window[first] : 0;
  }
}

// Returns the least cost of a split in which device and link take at most time_ns and each server at most servers_ns;
// kNever if there is none. w->band_begin then describes the split.
std::uint64_t least_cost(const SplitProblem& p, std::uint64_t time_ns, std::uint64_t servers_ns, SplitWorkspace* w) {
  ++w->search_count;
  std::uint32_t entries = p.row_count + 1;
  for (std::uint32_t b = 0; b < entries; ++b) w->least[b] = near_ns(p, b) <= time_ns ? p.device_cost[b] : kNever;
  for (std::uint32_t i = 0; i < p.server_count; ++i) {
    if (!p.servers[i].usable) continue;
    Array<std::uint64_t> swapped = w->least;
    w->least = w->least_before, w->least_before = swapped;
    extend_by_server(p, p.servers[i], servers_ns, w, w->band_begin.data + std::size_t(i) * entries);
  }
  return w->least[p.row_count];
}

std::uint64_t least_cost(const SplitProblem& p, std::uint64_t time_ns, SplitWorkspace* w) {
  return least_cost(p, time_ns, time_ns, w);
}

// Returns the split found by the last least_cost().
Split split_found(const SplitProblem& p, const SplitWorkspace& w) {
  Split split;
  split.server_count = p.server_count;
  std::uint32_t row = p.row_count;
  for (std::uint32_t i = p.server_count; i-- > 0;) {
    split.boundary[i + 1] = row;
    if (p.servers[i].usable) row = w.band_begin[std::size_t(i) * (p.row_count + 1) + row];
  }
  split.boundary[0] = row;
  predict_split(p, &split);
  return split;
}

std::uint64_t slowest_band_ns(const SplitProblem& p, const Split& split) {
  std::uint64_t slowest = 0;
  for (std::uint32_t i = 0; i < p.server_count; ++i)
    if (p.servers[i].usable) slowest = larger(slowest, band_ns(p.servers[i], split.boundary[i], split.boundary[i + 1]));
  return slowest;
}

std::uint64_t objective(const SplitProblem& p, const Split& split) {
  return split.time_ns + (p.weigh_cost ? split.cost : 0);
}

void keep_better(const SplitProblem& p, const Split& split, Split* best) {
  std::uint64_t now = objective(p, split), before = objective(p, *best);
  if (now < before || (now == before && split.cost < best->cost)) *best = split;
}

// Returns the fastest split within the cost cap, by bisection: costs fall as more time is allowed. `bound` is a split
// that meets the cap.
Split find_soonest(const SplitProblem& p, Split bound, SplitWorkspace* w) {
  std::uint64_t low = 0, high = bound.time_ns;
  while (low < high) {
    std::uint64_t middle = low + (high - low) / 2;
    std::uint64_t cost = least_cost(p, middle, w);
    if (cost != kNever && cost <= p.cost_cap)
      high = split_found(p, *w).time_ns;
    else
      low = middle + 1;
  }
  least_cost(p, high, w);
  return split_found(p, *w);
}

// Looks for a better sum of time and cost among splits between `soonest` and `cheapest` in both time and cost. A split
// that takes between t1 and t2 costs at least what the split at t2 costs, so the interval matters only if t1 plus that
// cost beats the best; halves the remaining intervals.
void weigh_time_against_cost(const SplitProblem& p, const Split& soonest, const Split& cheapest, SplitWorkspace* w,
                             Split* best) {
  struct Gap {
    std::uint64_t begin_ns, end_ns, begin_cost, end_cost;  // both ends have been evaluated
  };
  Gap gaps[64];  // halving leaves one per bit of the time
  std::uint32_t count = 0;
  auto add = [&](const Gap& gap) {
    if (gap.end_ns > gap.begin_ns + 1 && gap.end_cost < gap.begin_cost) gaps[count++] = gap;
  };
  add({soonest.time_ns, cheapest.time_ns, soonest.cost, cheapest.cost});
  while (count > 0) {
    Gap gap = gaps[--count];
    if (gap.begin_ns + 1 + gap.end_cost >= objective(p, *best)) continue;
    if (w->search_count >= kSearchMax) {
      best->exact = false;
      return;
    }
    // Beyond this time even the least cost would not be better.
    std::uint64_t useful_end = objective(p, *best) - gap.end_cost;
    if (useful_end < gap.end_ns) gap.end_ns = useful_end;
    std::uint64_t middle = gap.begin_ns + (gap.end_ns - gap.begin_ns) / 2;
    std::uint64_t cost = least_cost(p, middle, w);
    Split found = split_found(p, *w);
    keep_better(p, found, best);
    add({middle, gap.end_ns, cost, gap.end_cost});
    add({gap.begin_ns, found.time_ns, gap.begin_cost, cost});
  }
}

// Picks, among equally good splits, one whose slowest server finishes soonest. If device or link bound the time, other
// splits may idle one server while its neighbour is predicted to finish with no time to spare.
Split balance(const SplitProblem& p, const Split& best, SplitWorkspace* w) {
  std::uint64_t low = 0, high = best.time_ns;
  while (low < high) {
    std::uint64_t middle = low + (high - low) / 2;
    if (least_cost(p, best.time_ns, middle, w) <= best.cost)
      high = middle;
    else
      low = middle + 1;
  }
  least_cost(p, best.time_ns, high, w);
  Split balanced = split_found(p, *w);
  balanced.exact = best.exact;
  return balanced;
}

}  // namespace

std::size_t split_need(std::uint32_t row_count, std::uint32_t server_count) {
  std::size_t entries = std::size_t(row_count) + 1;
  return 2 * arena_need<std::uint64_t>(entries) + arena_need<std::uint16_t>(entries) +
         arena_need<std::uint16_t>(entries * server_count);
}

SplitWorkspace make_split_workspace(std::uint32_t row_count, std::uint32_t server_count, Arena* arena) {
  CHECK_LE(row_count, kImageSideMax);
  CHECK_LE(server_count, kServerCountMax);
  std::size_t entries = std::size_t(row_count) + 1;
  SplitWorkspace workspace;
  workspace.least = arena_array<std::uint64_t>(arena, entries);
  workspace.least_before = arena_array<std::uint64_t>(arena, entries);
  workspace.window = arena_array<std::uint16_t>(arena, entries);
  workspace.band_begin = arena_array<std::uint16_t>(arena, entries * server_count);
  workspace.search_count = 0;
  return workspace;
}

std::uint64_t band_ns(const ServerTables& server, std::uint32_t row_begin, std::uint32_t row_end) {
  if (row_begin == row_end) return 0;
  std::uint64_t rows = row_end - row_begin, chunk = rows < server.chunk_rows ? rows : server.chunk_rows;
  return server.start_ns + chunk * server.chunk_row_ns +
         larger(server.render_ns[row_end] - server.render_ns[row_begin],
                server.transfer_ns[row_end] - server.transfer_ns[row_begin]);
}

void predict_split(const SplitProblem& p, Split* split) {
  CHECK_EQ(split->server_count, p.server_count);
  CHECK_EQ(split->boundary[p.server_count], p.row_count);
  split->time_ns = near_ns(p, split->boundary[0]);
  split->cost = p.device_cost[split->boundary[0]];
  for (std::uint32_t i = 0; i < p.server_count; ++i) {
    std::uint32_t begin = split->boundary[i], end = split->boundary[i + 1];
    CHECK_LE(begin, end);
    if (begin == end) continue;
    CHECK(p.servers[i].usable);
    split->time_ns = larger(split->time_ns, band_ns(p.servers[i], begin, end));
    split->cost += p.servers[i].cost[end] - p.servers[i].cost[begin];
  }
  split->cap_met = split->cost <= p.cost_cap;
}

Split find_split(const SplitProblem& p, SplitWorkspace* w) {
  CHECK_EQ(w->least.count, p.row_count + 1);
  CHECK_LE(std::size_t(p.server_count) * (p.row_count + 1), w->band_begin.count);
  w->search_count = 0;
  least_cost(p, kNever - 1, w);
  Split cheapest = split_found(p, *w);
  if (!cheapest.cap_met) return cheapest;
  Split soonest = find_soonest(p, cheapest, w), best = soonest;
  if (p.weigh_cost) {
    // The cheapest split may take longer than necessary.
    keep_better(p, cheapest, &best);
    weigh_time_against_cost(p, soonest, cheapest, w, &best);
  }
  return p.server_count > 1 ? balance(p, best, w) : best;
}

Split next_split(const SplitProblem& p, const Split& previous, SplitWorkspace* w) {
  Split best = find_split(p, w);
  if (previous.server_count != p.server_count || previous.boundary[p.server_count] != p.row_count) return best;
  for (std::uint32_t i = 0; i < p.server_count; ++i)
    if (!p.servers[i].usable && previous.boundary[i] != previous.boundary[i + 1]) return best;
  Split kept = previous;
  predict_split(p, &kept);
  if (kept.cap_met != best.cap_met) return best;
  std::uint64_t value = objective(p, best), band = value / kDeadBandDivisor;
  bool as_good = objective(p, kept) <= value + band && slowest_band_ns(p, kept) <= slowest_band_ns(p, best) + band;
  return as_good ? kept : best;
}

}  // namespace pocketray
