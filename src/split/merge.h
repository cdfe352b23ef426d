// Merge: which rows of the current frame came from where. The device takes rows from the top, its own and then those
// that have not come; servers' chunks arrive from the bottom; they meet. Pixels are the same from everyone who is
// honest, so whoever is first wins, and a lost server costs time and no pixel; rows of one that sends wrong pixels can
// be discarded. Not for several threads at once.
#pragma once
#include <cstdint>

#include "base/arena.h"
#include "base/limits.h"

namespace pocketray {

enum class RowState : std::uint8_t { missing, taken, device, server };  // taken: the device is at work on it

struct MergeRow {
  RowState state = RowState::missing;
  std::uint8_t server = 0;  // which one, of state server
};

inline bool is_done(const MergeRow& row) { return row.state == RowState::device || row.state == RowState::server; }

struct Merge {
  std::uint32_t frame = 0;
  Array<MergeRow> rows;
  std::uint32_t next_row = 0;        // no row above it is missing
  std::uint32_t row_count_done = 0;  // of states device and server
};

std::size_t merge_need(std::uint32_t row_count);
Merge make_merge(std::uint32_t row_count, Arena* arena);

// Begins a frame: every row is missing.
void begin_merge(Merge* merge, std::uint32_t frame);

// Rows that the device is to render next: the topmost run of missing rows, at most row_count_max of them, now taken.
// False where none is missing.
bool take_rows(Merge* merge, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end);

// The device has rendered rows that it took. Those that came meanwhile stay the server's.
void finish_rows(Merge* merge, std::uint32_t row_begin, std::uint32_t row_end);

// A chunk has arrived. Returns how many of its rows were still open and are now done: their pixels are to be shown.
// None of a stale or future frame, of rows outside the picture, or of rows that were done before.
std::uint32_t accept_rows(Merge* merge, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_end,
                          std::uint32_t server);

// The rows of that server are not to be trusted: they are missing again. Returns how many there were.
std::uint32_t discard_rows(Merge* merge, std::uint32_t server);

inline bool is_complete(const Merge& merge) { return merge.row_count_done == merge.rows.count; }

// Rows of the frame that are the device's (server: kDeviceRows) or a server's.
constexpr std::uint32_t kDeviceRows = ~0u;
std::uint32_t count_rows(const Merge& merge, std::uint32_t server);

}  // namespace pocketray
