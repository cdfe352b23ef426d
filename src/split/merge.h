// Merge: the origin of each row of the current frame. The device takes rows from the top, first its own and then those
// that have not arrived; servers' chunks arrive in the requested order; they meet. Honest servers send the device's own
// pixels, so whoever is first wins, and a lost server costs time but no pixel; rows of a server that sends wrong pixels
// can be discarded. Not thread-safe.
#pragma once
#include <cstdint>

#include "base/arena.h"
#include "base/limits.h"

namespace pocketray {

enum class RowState : std::uint8_t { missing, taken, device, server };  // taken: the device is working on it

struct MergeRow {
  RowState state = RowState::missing;
  std::uint8_t server = 0;  // its index, if the state is server
};

inline bool is_done(const MergeRow& row) { return row.state == RowState::device || row.state == RowState::server; }

struct Merge {
  std::uint32_t frame = 0;
  Array<MergeRow> rows;
  std::uint32_t next_row = 0;        // no row above it is missing
  std::uint32_t row_count_done = 0;  // in state device or server
};

std::size_t merge_need(std::uint32_t row_count);
Merge make_merge(std::uint32_t row_count, Arena* arena);

// Begins a frame: every row is missing.
void begin_merge(Merge* merge, std::uint32_t frame);

// Takes the rows that the device renders next: the topmost run of missing rows, at most row_count_max of them. Returns
// false if none is missing.
bool take_rows(Merge* merge, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end);

// Takes the row, which must be missing.
void take_row(Merge* merge, std::uint32_t row);

// Marks rows as rendered by the device. Rows that arrived meanwhile stay the server's.
void finish_rows(Merge* merge, std::uint32_t row_begin, std::uint32_t row_end);

// Accepts a chunk. Returns how many of its rows were open and are now done: their pixels must be shown. 0 for a stale
// or future frame, rows outside the picture, and rows that were already done.
std::uint32_t accept_rows(Merge* merge, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_end,
                          std::uint32_t server);

// Marks the rows of an untrusted server as missing again. Returns their number.
std::uint32_t discard_rows(Merge* merge, std::uint32_t server);

inline bool is_complete(const Merge& merge) { return merge.row_count_done == merge.rows.count; }

// Number of rows done by the device (server: kDeviceRows) or by a server.
constexpr std::uint32_t kDeviceRows = ~0u;
std::uint32_t count_rows(const Merge& merge, std::uint32_t server);

}  // namespace pocketray
