#include "remote/cluster/row_share.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

// Rows per thread of a piece: those of a strip of tiles, or half of them if there are few; fewer cost more each
// (measured: a row of cornell by itself 2.4 times as much, four together 1.1 times).
constexpr std::uint32_t kStripRows = 8, kFewRows = 4;

std::uint32_t window_end(const RowShare& share, std::uint32_t window) {
  return share.front + std::min(window, share.count - share.front);
}

// Finds a row of the window that the rank has in part, else a free one that it had in the last frame, else one that
// nobody had, else any; returns the window's end if there is none.
std::uint32_t find_row(const RowShare& share, std::uint16_t rank, const PieceLimits& limits) {
  const std::uint32_t end = window_end(share, limits.window);
  std::uint32_t own = end, unowned = end, any = end;
  for (std::uint32_t i = share.front; i < end; ++i) {
    const SharedRow& row = share.rows[i];
    if (row.rank == rank && row.columns_given < share.width) return i;
    if (row.rank != kNoRank) continue;
    const std::uint16_t owner = share.owners[row.row];
    if (owner == rank) own = std::min(own, i);
    if (owner == kNoRank) unowned = std::min(unowned, i);
    any = std::min(any, i);
  }
  if (own < end) return own;
  if (unowned < end) return unowned;
  return limits.any ? any : end;
}

}  // namespace

bool operator==(const RowPiece& a, const RowPiece& b) {
  return a.row_begin == b.row_begin && a.row_end == b.row_end && a.column_begin == b.column_begin &&
         a.column_end == b.column_end;
}

void make_row_share(std::uint32_t height_max, RowShare* share) {
  CHECK(share != nullptr && height_max > 0);
  share->rows.resize(height_max);
  share->places.resize(height_max);
  share->owners.assign(height_max, kNoRank);
  share->row_pixels.resize(height_max);
}

void begin_row_share(const FrameRequest& request, bool keeps_rows, RowShare* share) {
  CHECK(request.row_begin < request.row_end && request.row_end <= share->rows.size());
  if (!keeps_rows) std::fill(share->owners.begin(), share->owners.end(), kNoRank);
  share->count = share->front = 0;
  share->width = request.settings.width;
  for (RowSequence at = first_rows(request); has_rows(at); pass_rows(request, 1, &at)) {
    const std::uint16_t row = static_cast<std::uint16_t>(at.row_end - 1);
    share->places[row] = static_cast<std::uint16_t>(share->count);
    share->row_pixels[row] = 0;
    share->rows[share->count++] = {row, kNoRank, 0, 0};
  }
  CHECK_EQ(share->count, static_cast<std::uint32_t>(request.row_end - request.row_begin));
}

std::uint32_t window_rows(std::uint32_t rest, std::uint32_t chunk_rows, std::uint32_t thread_count) {
  CHECK(chunk_rows > 0 && thread_count > 0);
  return rest + std::max(chunk_rows, 2 * kStripRows * thread_count);
}

std::uint32_t piece_rows(std::uint32_t left_count, double speed_part, std::uint32_t rank_threads) {
  CHECK(speed_part >= 0 && speed_part <= 1);
  return (left_count * speed_part >= kStripRows * rank_threads ? kStripRows : kFewRows) * rank_threads;
}

std::uint32_t free_rows(const RowShare& share, std::uint32_t window) {
  const SharedRow* rows = share.rows.data();
  return static_cast<std::uint32_t>(std::count_if(rows + share.front, rows + window_end(share, window),
                                                  [](const SharedRow& row) { return row.rank == kNoRank; }));
}

bool take_piece(RowShare* share, std::uint16_t rank, const PieceLimits& limits, RowPiece* piece) {
  CHECK(limits.rows > 0 && limits.pixels > 0 && rank != kNoRank);
  const std::uint32_t end = window_end(*share, limits.window), first = find_row(*share, rank, limits);
  if (first == end) return false;
  SharedRow* row = &share->rows[first];
  row->rank = rank;
  if (row->columns_given > 0 || limits.pixels < share->width) {
    const std::uint32_t columns = std::min(limits.pixels, share->width - row->columns_given);
    *piece = {row->row, row->row + 1u, row->columns_given, row->columns_given + columns};
    row->columns_given += columns;
    return true;
  }
  const std::uint16_t owner = share->owners[row->row];
  const std::uint32_t rows_max = std::min(limits.rows, limits.pixels / share->width);
  std::uint32_t rows = 0;
  do {
    share->rows[first + rows].rank = rank;
    share->rows[first + rows].columns_given = share->width;
    ++rows;
  } while (rows < rows_max && first + rows < end && share->rows[first + rows].rank == kNoRank &&
           share->rows[first + rows].row + rows == row->row && share->owners[share->rows[first + rows].row] == owner);
  // Ends at a multiple of half a tile, if it reaches one: strips are aligned.
  const std::uint32_t begin = row->row + 1u - rows, aligned = (begin + kFewRows - 1) / kFewRows * kFewRows;
  const std::uint32_t left_out = aligned <= row->row ? aligned - begin : 0;
  for (std::uint32_t i = rows - left_out; i < rows; ++i)
    share->rows[first + i].rank = kNoRank, share->rows[first + i].columns_given = 0;
  *piece = {begin + left_out, row->row + 1u, 0, share->width};
  return true;
}

bool end_piece(RowShare* share, std::uint16_t rank, const RowPiece& piece) {
  CHECK(piece.row_begin < piece.row_end && piece.row_end <= share->places.size());
  for (std::uint32_t i = piece.row_begin; i < piece.row_end; ++i) {
    SharedRow* row = &share->rows[share->places[i]];
    CHECK(row->row == i && row->rank == rank);
    CHECK_EQ(row->columns_done, piece.column_begin);
    row->columns_done = piece.column_end;
    if (row->columns_done == share->width) share->owners[i] = rank;
  }
  while (share->front < share->count && share->rows[share->front].columns_done == share->width) ++share->front;
  return piece.column_end == share->width;
}

void take_back_rows(RowShare* share, std::uint16_t rank) {
  CHECK_LE(share->front, share->count);
  for (std::uint32_t i = share->front; i < share->count; ++i) {
    SharedRow* row = &share->rows[i];
    if (row->rank == rank && row->columns_done < share->width) *row = {row->row, kNoRank, 0, 0};
  }
  std::replace(share->owners.begin(), share->owners.end(), rank, kNoRank);
}

}  // namespace pocketray
