// The split of a frame's rows among the device and its servers that finishes soonest, or also weighs cost. Rows
// [boundary[0], boundary[1]) are the first server's, and so on downward; the device has the rows above boundary[0].
// Integers throughout: the split is equal on every CPU, and no float hides an undefined unit.
#pragma once
#include <cstdint>

#include "base/arena.h"
#include "base/limits.h"

namespace pocketray {

// Chosen; up to three are measured (tests/split_report/FIGURES.md). Table sizes and the effort of find_split() grow
// with it.
constexpr std::uint32_t kServerCountMax = 8;
// Limit per row in any table; 18 minutes as nanoseconds. Derived: sums over kImageSideMax rows are at most 2⁵³, exact
// as doubles.
constexpr std::uint64_t kRowTableMax = std::uint64_t(1) << 40;

// Prefix sums: table[r] is the sum over rows 0 … r − 1; row_count + 1 entries, at most kRowTableMax per row.
using RowTable = const std::uint64_t*;

struct ServerTables {
  bool usable = false;             // false: gets no rows, its tables may be null
  RowTable render_ns = nullptr;    // to render a row on the server
  RowTable transfer_ns = nullptr;  // to send it, as it compresses
  RowTable cost = nullptr;         // of the transfer
  std::uint64_t start_ns = 0;      // once per band: latency and preparation; at most kRowTableMax
  std::uint32_t chunk_rows = 1;    // rows sent at once
  std::uint64_t chunk_row_ns = 0;  // smaller of rendering and sending a row: the pipeline's first or last chunk adds it
                                   // to the larger; at most kRowTableMax
};

struct SplitProblem {
  std::uint32_t row_count = 0;                           // at most kImageSideMax
  std::uint32_t server_count = 0;                        // at most kServerCountMax
  RowTable device_ns = nullptr;                          // to render a row on the device
  RowTable unpack_ns = nullptr;                          // device time per received row
  RowTable link_ns = nullptr;                            // time per received row on the link that all servers share
  RowTable device_cost = nullptr;                        // of rendering a row on the device
  std::uint64_t device_start_ns = 0, link_start_ns = 0;  // before the first row; at most kRowTableMax
  std::uint64_t device_least_ns = 0;  // the device finishes no sooner if it has rows; at most kRowTableMax
  bool weigh_cost = false;            // true: minimise time + cost; false: time, then cost among equals
  std::uint64_t cost_cap = ~std::uint64_t(0);
  ServerTables servers[kServerCountMax];
};

struct Split {
  std::uint32_t server_count = 0;
  std::uint32_t boundary[kServerCountMax + 1] = {};  // ascending; boundary[server_count] is the row count
  std::uint64_t time_ns = 0, cost = 0;               // predicted
  bool cap_met = true;                               // false: no split is that cheap; this is the cheapest
  bool exact = true;  // false: too many splits weigh time against cost equally; this is the best of kSearchMax
};

// Scratch memory of find_split().
struct SplitWorkspace {
  Array<std::uint64_t> least, least_before;
  Array<std::uint16_t> window, band_begin;
  std::uint32_t search_count;  // number of least costs computed in the last call
};
std::size_t split_need(std::uint32_t row_count, std::uint32_t server_count);
SplitWorkspace make_split_workspace(std::uint32_t row_count, std::uint32_t server_count, Arena* arena);

// Predicted time of a band of rows on a server: the start, the larger of rendering and sending, which overlap, and one
// chunk of the smaller. 0 without rows. Never decreases as a band grows.
std::uint64_t band_ns(const ServerTables& server, std::uint32_t row_begin, std::uint32_t row_end);

// Computes time_ns and cost from the boundaries: the time is when the last of device, link and servers finishes.
void predict_split(const SplitProblem& problem, Split* split);

// Returns the best of all splits that cost at most the cap: least time, then least cost; or least time + cost. Among
// equally good splits, the one whose slowest server finishes soonest. Effort: about 30 · servers · rows steps, 60 with
// several servers; at most (kSearchMax + 60) · servers · rows.
Split find_split(const SplitProblem& problem, SplitWorkspace* workspace);

// find_split() with hysteresis: keeps `previous` while it, and the slowest of its servers, is predicted to be worse by
// at most 1/kDeadBandDivisor of the time.
Split next_split(const SplitProblem& problem, const Split& previous, SplitWorkspace* workspace);

// Chosen: more than any problem of tests/split/split_test.cpp needs. Bounds the effort; with less, more splits would
// not be exact.
constexpr std::uint32_t kSearchMax = 1024;
constexpr std::uint64_t kDeadBandDivisor = 50;  // 2 %: measurement noise moves no rows; less than half of the 5 % by
                                                // which a split may miss the best

}  // namespace pocketray
