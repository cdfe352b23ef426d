// Orders of rows, judged by the flow shop.
#include "split/row_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "base/rng.h"
#include "split/flow_shop.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// Times of rows, and a server's tables of them.
struct Rows {
  std::vector<std::uint64_t> trace = {0}, send = {0};
  ServerTables server;
  Rows(std::uint32_t count, const std::function<double(std::uint32_t)>& trace_ns,
       const std::function<double(std::uint32_t)>& send_ns) {
    for (std::uint32_t row = 0; row < count; ++row) {
      trace.push_back(trace.back() + static_cast<std::uint64_t>(trace_ns(row)));
      send.push_back(send.back() + static_cast<std::uint64_t>(send_ns(row)));
    }
    server.usable = true, server.render_ns = trace.data(), server.transfer_ns = send.data();
  }
  ShopJob job(RowRange run, double send_factor = 1) const {
    return {run.begin, run.end, double(trace[run.end] - trace[run.begin]),
            send_factor * double(send[run.end] - send[run.begin])};
  }
};

std::vector<ShopJob> jobs_of(const Rows& rows, const RowOrder& order, double send_factor = 1) {
  std::vector<ShopJob> jobs;
  for (std::uint32_t i = 0; i < order.run_count; ++i) jobs.push_back(rows.job(order.runs[i], send_factor));
  return jobs;
}

void check_rows_once(const RowOrder& order, std::uint32_t row_begin, std::uint32_t row_end) {
  REQUIRE(order.run_count >= 1);
  REQUIRE(order.run_count <= kOrderRunsMax);
  std::vector<RowRange> runs(order.runs, order.runs + order.run_count);
  std::sort(runs.begin(), runs.end(), [](RowRange a, RowRange b) { return a.begin < b.begin; });
  std::uint32_t row = row_begin;
  for (const RowRange& run : runs) {
    REQUIRE(run.begin == row);
    REQUIRE(run.end > run.begin);
    CHECK(run.end - run.begin <= kRunRowsMax);
    row = run.end;
  }
  CHECK(row == row_end);
}

}  // namespace

// Goal: an order has every row of the band once, in as many runs as a request can state. Method: bands of all sizes,
// rows that cost nothing, the same, at random, and as much as a table may hold.
TEST_CASE("row_order_has_every_row_once") {
  Rng rng = make_rng(41);
  auto none = [](std::uint32_t) { return 0.0; };
  auto some = [](std::uint32_t) { return 1000.0; };
  auto most = [](std::uint32_t) { return double(kRowTableMax); };
  auto random = [&](std::uint32_t) { return std::exp(20 * next_double(&rng)); };
  const std::function<double(std::uint32_t)> costs[] = {none, some, most, random};
  for (std::uint32_t height : {1u, 2u, 3u, 17u, 64u, 240u, 641u, 2000u, 8192u})
    for (const auto& trace : costs)
      for (const auto& send : costs) {
        const Rows rows(height, trace, send);
        for (int round = 0; round < 4; ++round) {
          const std::uint32_t begin = round == 0 ? 0 : next_u32(&rng) % height;
          const std::uint32_t end = round == 0 ? height : begin + 1 + next_u32(&rng) % (height - begin);
          RowOrder order;
          order_rows(rows.server, begin, end, 1 + round, &order);
          check_rows_once(order, begin, end);
        }
      }
}

// Goal: tracing and sending overlap: the last row comes hardly later than the longer of the two stages alone would
// take. Method: bands whose lower rows compress to nothing, in which either stage is the longer, or both are as long;
// rows at random. Judged by the simulation, which also tells what rows from the bottom upward would take.
TEST_CASE("row_order_reaches_full_overlap") {
  Rng rng = make_rng(42);
  constexpr std::uint32_t kRows = 228;
  constexpr double kTrace = 1000;
  struct Case {
    const char* what;
    double send;  // of a row, as a mean, over that of tracing it
    double bound;
    std::function<double(std::uint32_t)> shape;  // of the bytes
  };
  auto cheap_end = [](std::uint32_t row) { return row > 180 ? 0.2 : 1.0; };
  auto cheap_ends = [](std::uint32_t row) { return row > 180 || row < 60 ? 0.1 : 1.0; };
  auto random = [&](std::uint32_t) { return 0.2 + next_double(&rng); };
  const Case cases[] = {{"the link is slower", 2, 1.012, cheap_end},    {"the server is slower", 0.5, 1.012, cheap_end},
                        {"both are as slow", 1, 1.04, cheap_end},       {"cheap at both ends", 1, 1.04, cheap_ends},
                        {"at random, slow link", 1.5, 1.012, random},   {"at random, slow server", 0.7, 1.012, random},
                        {"at random, both as slow", 1.02, 1.05, random}};
  for (const Case& c : cases) {
    double sum = 0;
    std::vector<double> shape;
    for (std::uint32_t row = 0; row < kRows; ++row) shape.push_back(c.shape(row)), sum += shape.back();
    const Rows rows(
        kRows, [&](std::uint32_t) { return kTrace; },
        [&](std::uint32_t row) { return c.send * kTrace * kRows * shape[row] / sum; });
    RowOrder order;
    order_rows(rows.server, 0, kRows, 1, &order);
    const double longer = std::max(double(rows.trace.back()), double(rows.send.back()));
    const double took = shop_ns(jobs_of(rows, order), 0);
    std::vector<ShopJob> bottom_first;
    for (std::uint32_t end = kRows; end > 0; end -= std::min(end, 8u))
      bottom_first.push_back(rows.job({end - std::min(end, 8u), end}));
    std::printf("%-24s %u runs: %.4f of full overlap, from the bottom upward %.4f\n", c.what, order.run_count,
                took / longer, shop_ns(bottom_first, 0) / longer);
    CAPTURE(c.what);
    CHECK(took <= c.bound * longer);
    CHECK(took <= 1.001 * shop_ns(bottom_first, 0));
    std::vector<ShopJob> sorted = jobs_of(rows, order);
    sort_jobs(&sorted);
    CHECK(took <= 1.02 * shop_ns(sorted, 0));
  }
}

// Goal: what else a link carries counts. Method: a server that is slower than its link alone, and faster than the link
// that others use, too.
TEST_CASE("row_order_counts_what_a_link_carries_besides") {
  const Rows rows(
      200, [](std::uint32_t) { return 1000.0; }, [](std::uint32_t row) { return row < 100 ? 400.0 : 600.0; });
  RowOrder alone, shared;
  order_rows(rows.server, 0, 200, 1, &alone);
  order_rows(rows.server, 0, 200, 3, &shared);
  CHECK(shop_ns(jobs_of(rows, shared, 3), 0) < shop_ns(jobs_of(rows, alone, 3), 0));
  CHECK(shop_ns(jobs_of(rows, alone), 0) <= shop_ns(jobs_of(rows, shared), 0));
  // Runs are short where the other stage would wait: at the start if the link is slower, else at the end.
  CHECK(shared.runs[0].end - shared.runs[0].begin == 2);
  const RowRange last = alone.runs[alone.run_count - 1];
  CHECK(last.end - last.begin == 2);
}

// Goal: while nothing is known, rows come from the bottom upward, as the device begins at the top.
TEST_CASE("row_order_of_equal_rows_is_from_the_bottom_upward") {
  const Rows rows(
      240, [](std::uint32_t) { return 1000.0; }, [](std::uint32_t) { return 900.0; });
  RowOrder order;
  order_rows(rows.server, 32, 240, 1, &order);
  std::uint32_t end = 240;
  for (std::uint32_t i = 0; i < order.run_count; ++i) {
    CHECK(order.runs[i].end == end);
    end = order.runs[i].begin;
  }
}
