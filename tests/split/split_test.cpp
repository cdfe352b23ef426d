// The exact split against exhaustive search.
#include "split/split.h"

#include <doctest/doctest.h>

#include <cstdio>

#include "split/split_oracle.h"
#include "support/effort.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

enum class Kind { time, weighed, capped, weighed_and_capped };
constexpr Kind kKinds[] = {Kind::time, Kind::weighed, Kind::capped, Kind::weighed_and_capped};

void set_kind(Kind kind, Rng* rng, SplitProblem* p) {
  p->weigh_cost = kind == Kind::weighed || kind == Kind::weighed_and_capped;
  if (kind == Kind::capped || kind == Kind::weighed_and_capped)
    p->cost_cap =
        static_cast<std::uint64_t>(next_double(rng) * 1.5 * static_cast<double>(p->device_cost[p->row_count]));
}

// Compares with best_of_all(); returns how many least costs were computed.
std::uint32_t compare(const SplitProblem& p) {
  OwnWorkspace own(p.row_count, p.server_count);
  Split split = find_split(p, &own.workspace);
  Best best = best_of_all(p);
  CAPTURE(p.row_count);
  CAPTURE(p.server_count);
  std::uint64_t cost, time = judge(p, split.boundary, &cost);
  CHECK(split.time_ns == time);
  CHECK(split.cost == cost);
  CHECK(split.exact);
  if (best.objective == ~std::uint64_t(0)) {
    CHECK(!split.cap_met);
    CHECK(cost == best.least_cost);
  } else {
    CHECK(split.cap_met);
    CHECK(time + (p.weigh_cost ? cost : 0) == best.objective);
    if (!p.weigh_cost) CHECK(cost == best.cost);
    if (cost == best.cost) CHECK(slowest_band(p, split.boundary) == best.slowest_band);
  }
  return own.workspace.search_count;
}

}  // namespace

// Goal: the split is the best of all, including ties, for every goal. Method: random problems of 240 rows and one, two
// and three servers against all splits (2.3 million for three); small ones with many ties.
TEST_CASE("hard_61_split_equals_the_best_of_all_splits") {
  Rng rng = make_rng(61);
  std::uint32_t search_max = 0;
  auto run = [&](std::uint32_t row_count, std::uint32_t server_count, std::uint64_t scale, int rounds) {
    for (int round = 0; round < rounds; ++round)
      for (Kind kind : kKinds) {
        auto g = random_problem(row_count, server_count, scale, &rng);
        set_kind(kind, &rng, &g->problem);
        search_max = std::max(search_max, compare(g->problem));
      }
  };
  run(240, 1, 100000, gate_share(200, 2000));
  run(240, 2, 100000, gate_share(20, 200));
  run(240, 2, 12, gate_share(10, 200));
  run(240, 3, 100000, gate_share(3, 20));
  for (std::uint32_t rows = 0; rows <= 12; ++rows)
    for (std::uint32_t servers = 0; servers <= 3; ++servers) {
      run(rows, servers, 1000000, effort(20));
      run(rows, servers, 5, effort(40));
    }
  run(9, 5, 40, effort(20));
  std::printf("least costs computed for one split: at most %u\n", search_max);
  CHECK(search_max < kSearchMax);
  count_assertions("= the best of all splits");
}

// Goal: HARDCASES row 61: servers that take no time get every row; infinitely slow ones get none.
TEST_CASE("hard_61_server_time_zero_takes_all_rows") {
  for (std::uint32_t rows : {0u, 1u, 240u}) {
    GeneratedProblem g;
    g.problem.row_count = rows, g.problem.server_count = 1;
    RowTable nothing = make_table(&g, [](std::uint32_t) { return 0u; });
    RowTable forever = make_table(&g, [](std::uint32_t) { return kRowTableMax; });
    g.problem.unpack_ns = g.problem.link_ns = g.problem.device_cost = nothing;
    g.problem.device_ns = make_table(&g, [](std::uint32_t) { return 1000u; });
    ServerTables* s = &g.problem.servers[0];
    s->usable = true, s->cost = nothing;
    OwnWorkspace own(rows, 1);
    s->render_ns = s->transfer_ns = nothing;
    CHECK(find_split(g.problem, &own.workspace).boundary[0] == 0);
    s->render_ns = forever;
    CHECK(find_split(g.problem, &own.workspace).boundary[0] == rows);
    s->render_ns = nothing, s->transfer_ns = forever;
    CHECK(find_split(g.problem, &own.workspace).boundary[0] == rows);
    g.problem.device_ns = forever;
    Split split = find_split(g.problem, &own.workspace);
    CHECK(split.time_ns <= kRowTableMax * 240);
    CHECK(split.boundary[0] <= rows);
  }
}

// Goal: with equal rows the split is the closed form's. Method: Table 1's first row without starts and chunks: 240 rows
// of 320 pixels; the overlapped share to within a row.
TEST_CASE("split_of_equal_rows_is_the_closed_form") {
  GeneratedProblem g;
  g.problem.row_count = 240, g.problem.server_count = 1;
  auto table = [&](std::uint64_t ns) { return make_table(&g, [=](std::uint32_t) { return ns * 320; }); };
  g.problem.device_ns = table(8841);
  g.problem.unpack_ns = g.problem.link_ns = g.problem.device_cost = table(0);
  g.problem.servers[0].usable = true;
  g.problem.servers[0].render_ns = table(989), g.problem.servers[0].transfer_ns = table(400);
  g.problem.servers[0].cost = table(1);
  OwnWorkspace own(240, 1);
  Split split = find_split(g.problem, &own.workspace);
  CHECK(split.boundary[0] == 24);  // 240 · 989 / (8841 + 989) = 24.1
  CHECK(static_cast<double>(split.time_ns) / (320 * 240) < 890 * 1.005);
}

// Goal: three equal servers without a shared link take equal bands. If the link is the limit, more servers do not help,
// the device does the rest, and the bands are still equal.
TEST_CASE("split_divides_among_servers_until_the_link_is_full") {
  GeneratedProblem g;
  g.problem.row_count = 240, g.problem.server_count = 3;
  auto table = [&](std::uint64_t ns) { return make_table(&g, [=](std::uint32_t) { return ns; }); };
  RowTable nothing = table(0);
  g.problem.device_ns = table(1000);
  g.problem.unpack_ns = g.problem.link_ns = g.problem.device_cost = nothing;
  for (int i = 0; i < 3; ++i) {
    g.problem.servers[i].usable = true;
    g.problem.servers[i].render_ns = table(1000), g.problem.servers[i].transfer_ns = table(10);
    g.problem.servers[i].cost = table(1);
  }
  OwnWorkspace own(240, 3);
  Split split = find_split(g.problem, &own.workspace);
  CHECK(split.time_ns == 60000);
  for (std::uint32_t i = 0; i < 4; ++i) CHECK(split.boundary[i] == 60 * (i + 1));
  g.problem.link_ns = table(1000);
  split = find_split(g.problem, &own.workspace);
  CHECK(split.time_ns == 120000);
  for (std::uint32_t i = 0; i < 4; ++i) CHECK(split.boundary[i] == 120 + 40 * i);
}

// Goal: hysteresis keeps a split while another would gain less than the dead band, and drops it beyond, or at once if a
// server is gone or the number of rows changes.
TEST_CASE("next_split_stays_until_the_gain_is_worth_it") {
  GeneratedProblem g;
  g.problem.row_count = 240, g.problem.server_count = 1;
  auto table = [&](std::uint64_t ns) { return make_table(&g, [=](std::uint32_t) { return ns; }); };
  g.problem.device_ns = table(1000);
  g.problem.unpack_ns = g.problem.link_ns = g.problem.device_cost = table(0);
  ServerTables* s = &g.problem.servers[0];
  s->usable = true, s->render_ns = table(1000), s->transfer_ns = table(10), s->cost = table(1);
  OwnWorkspace own(240, 1);
  Split first = find_split(g.problem, &own.workspace);
  CHECK(first.boundary[0] == 120);
  s->render_ns = table(1015);
  CHECK(next_split(g.problem, first, &own.workspace).boundary[0] == 120);
  s->render_ns = table(1100);
  CHECK(next_split(g.problem, first, &own.workspace).boundary[0] == 126);
  s->render_ns = table(1015), s->usable = false;
  CHECK(next_split(g.problem, first, &own.workspace).boundary[0] == 240);
  s->usable = true;
  Split other = first;
  other.server_count = 0, other.boundary[0] = 240;
  CHECK(next_split(g.problem, other, &own.workspace).boundary[0] != 120);
}

// Goal: hysteresis drops a split that leaves servers idle while one has no time to spare, even if the link bounds the
// time of both.
TEST_CASE("next_split_lets_go_of_unequal_bands") {
  GeneratedProblem g;
  g.problem.row_count = 240, g.problem.server_count = 2;
  auto table = [&](std::uint64_t ns) { return make_table(&g, [=](std::uint32_t) { return ns; }); };
  g.problem.device_ns = table(1000000);
  g.problem.unpack_ns = g.problem.device_cost = table(0), g.problem.link_ns = table(1000);
  for (int i = 0; i < 2; ++i) {
    ServerTables* s = &g.problem.servers[i];
    s->usable = true, s->render_ns = table(1000), s->transfer_ns = table(1000), s->cost = table(1);
  }
  OwnWorkspace own(240, 2);
  Split split;
  split.server_count = 2;
  split.boundary[1] = split.boundary[2] = 240;
  CHECK(next_split(g.problem, split, &own.workspace).boundary[1] == 120);
  split.boundary[1] = 121;
  CHECK(next_split(g.problem, split, &own.workspace).boundary[1] == 121);
}

// Goal: a workspace takes exactly split_need().
TEST_CASE("split_need_is_what_the_workspace_takes") {
  std::vector<std::uint8_t> block(1 << 22);
  for (std::uint32_t rows : {0u, 1u, 240u, 8192u})
    for (std::uint32_t servers : {0u, 1u, 8u}) {
      Arena arena = make_arena("split", block.data(), block.size());
      make_split_workspace(rows, servers, &arena);
      CHECK(arena.used == split_need(rows, servers));
    }
}
