// The order in which a server traces and sends the rows of a band. Tracing and sending form a two-machine flow shop: if
// rows that take longer on the link come first and the others last [Johnson 1954], the link is busy soon after the
// start, and little is left to send at the end.
#pragma once
#include "base/span.h"
#include "split/split.h"

namespace pocketray {

constexpr std::uint32_t kOrderRunsMax = 64, kRunRowsMax = 255;  // derived: what a request can express (PROTOCOL.md)

struct RowOrder {
  std::uint32_t run_count = 0;
  RowRange runs[kOrderRunsMax];  // in tracing order; each from its lowest row upward
};

// Orders rows [row_begin, row_end), at least one. On the link, a row takes `send_factor` times its time in the table.
void order_rows(const ServerTables& server, std::uint32_t row_begin, std::uint32_t row_end, double send_factor,
                RowOrder* order);

}  // namespace pocketray
