#include "split/row_order.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

// Measured by split_report's overlap tests: smaller blocks need more messages, larger ones make the link wait. Blocks
// lie on a grid of the picture, so that rows are cut as in the last frame.
constexpr std::uint32_t kBlockRows = 24, kBlocksMax = 40, kRunRowsMin = 2;
static_assert(kBlocksMax + 1 < kOrderRunsMax, "some blocks can be cut");
static_assert((kImageSideMax / kBlocksMax / kBlockRows + 1) * kBlockRows <= kRunRowsMax,
              "no block is longer than a run");

struct Stages {
  double trace_ns, send_ns;
};

struct Cutter {
  const ServerTables* server;
  double send_factor;
  RowRange blocks[kBlocksMax + 1];
  std::uint32_t block_count = 0;

  Stages of(RowRange rows) const {
    return {static_cast<double>(server->render_ns[rows.end] - server->render_ns[rows.begin]),
            static_cast<double>(server->transfer_ns[rows.end] - server->transfer_ns[rows.begin]) * send_factor};
  }
  // The link's fraction of the row range's total time.
  double link_part(RowRange rows) const {
    const Stages s = of(rows);
    return s.send_ns + s.trace_ns > 0 ? s.send_ns / (s.send_ns + s.trace_ns) : 0;
  }
};

// Sorts blocks that keep the link busy longest relative to their server time first. For arbitrarily fine cuts this is
// Johnson's order, and no other order has more to send at any time. On ties, the lowest block comes first.
void sort_blocks(Cutter* c) {
  std::sort(c->blocks, c->blocks + c->block_count, [c](RowRange a, RowRange b) {
    const double x = c->link_part(a), y = c->link_part(b);
    return x != y ? x > y : a.begin > b.begin;
  });
}

// Number of rows of a run that the first stage finishes while the second still has work for `slack_ns`, taken from the
// end of the next block; at least somewhat more than `rows_before`.
template <class First>
std::uint32_t fitting_rows(RowRange block, double slack_ns, std::uint32_t rows_before, First first_ns) {
  const std::uint32_t all = block.end - block.begin;
  std::uint32_t rows = std::max(kRunRowsMin, rows_before + std::max(1u, rows_before / 4));
  while (rows < all && first_ns(rows + 1) <= slack_ns) ++rows;
  return rows + kRunRowsMin > all ? all : rows;
}

}  // namespace

void order_rows(const ServerTables& server, std::uint32_t row_begin, std::uint32_t row_end, double send_factor,
                RowOrder* order) {
  CHECK_LT(row_begin, row_end);
  CHECK(server.usable && server.render_ns != nullptr && server.transfer_ns != nullptr);
  Cutter c;
  c.server = &server, c.send_factor = send_factor;
  const std::uint32_t block_rows = ((row_end - row_begin - 1) / kBlocksMax / kBlockRows + 1) * kBlockRows;
  for (std::uint32_t end = row_end; end > row_begin; end = c.blocks[c.block_count - 1].begin) {
    CHECK_LE(c.block_count, kBlocksMax);
    c.blocks[c.block_count++] = {std::max(row_begin, (end - 1) / block_rows * block_rows), end};
  }
  sort_blocks(&c);
  // From the front, runs last as long as the link has something to send meanwhile; from the back, as long as the server
  // has something to trace while they are sent.
  RowRange back[kOrderRunsMax];
  std::uint32_t front_blocks = 0, back_count = 0, spare = kOrderRunsMax - c.block_count, rows = 0;
  order->run_count = 0;
  double slack = 0;
  for (; front_blocks < c.block_count && c.link_part(c.blocks[front_blocks]) > 0.5; ++front_blocks) {
    for (RowRange left = c.blocks[front_blocks]; left.begin < left.end;) {
      auto trace_ns = [&](std::uint32_t n) { return c.of({left.end - n, left.end}).trace_ns; };
      rows = spare > 0 ? fitting_rows(left, slack, rows, trace_ns) : left.end - left.begin;
      const RowRange run = {left.end - rows, left.end};
      if (run.begin > left.begin) --spare;
      slack = std::max(0.0, slack - c.of(run).trace_ns) + c.of(run).send_ns;
      order->runs[order->run_count++] = run;
      left.end = run.begin;
    }
  }
  slack = 0, rows = 0;
  for (std::uint32_t i = c.block_count; i > front_blocks; --i) {
    for (RowRange left = c.blocks[i - 1]; left.begin < left.end;) {
      auto send_ns = [&](std::uint32_t n) { return c.of({left.begin, left.begin + n}).send_ns; };
      rows = spare > 0 ? fitting_rows(left, slack, rows, send_ns) : left.end - left.begin;
      const RowRange run = {left.begin, left.begin + rows};
      if (run.end < left.end) --spare;
      slack = std::max(0.0, slack - c.of(run).send_ns) + c.of(run).trace_ns;
      back[back_count++] = run;
      left.begin = run.end;
    }
  }
  CHECK_LE(order->run_count + back_count, kOrderRunsMax);
  while (back_count > 0) order->runs[order->run_count++] = back[--back_count];
}

}  // namespace pocketray
