// Decides which rank traces which rows of a request. Pure. Rows are assigned in the requested order, within a window
// that begins at the first untraced row. A row belongs to one rank, so that the rank can keep it for the next frame,
// and each rank first gets rows that it traced in the last one (temporal coherence).
#pragma once
#include <cstdint>
#include <vector>

#include "wire/row_sequence.h"

namespace pocketray {

// Consecutive rows of a request, or columns of one row.
struct RowPiece {
  std::uint32_t row_begin = 0, row_end = 0, column_begin = 0, column_end = 0;
};
inline std::uint32_t pixel_count(const RowPiece& piece) {
  return (piece.row_end - piece.row_begin) * (piece.column_end - piece.column_begin);
}
bool operator==(const RowPiece& a, const RowPiece& b);

constexpr std::uint16_t kNoRank = 0xFFFF;

struct SharedRow {
  std::uint16_t row, rank;                    // rank: the owner; kNoRank: nobody yet
  std::uint32_t columns_given, columns_done;  // from the left
};

struct RowShare {
  std::vector<SharedRow> rows;            // in the requested order
  std::vector<std::uint16_t> places;      // place in that order, by row of the picture
  std::vector<std::uint16_t> owners;      // rank that traced it in the last frame, by row of the picture
  std::vector<std::uint32_t> row_pixels;  // number of pixels traced, by row of the picture
  std::uint32_t count = 0;                // rows of the request
  std::uint32_t front = 0;                // number of rows traced without a gap
  std::uint32_t width = 0;
};

// Allocates memory for pictures of at most that many rows.
void make_row_share(std::uint32_t height_max, RowShare* share);
// Begins a request. keeps_rows: ranks trace less of rows that they had in the last one.
void begin_row_share(const FrameRequest& request, bool keeps_rows, RowShare* share);

// Limits on what a rank gets at once.
struct PieceLimits {
  std::uint32_t window = 1, rows = 1, pixels = 1;  // window: rows counted from the front
  bool any = true;                                 // also rows that others had in the last frame
};
// Size of the window that begins with the rest of a chunk: another chunk, which the ranks trace while the first is
// encoded, or two strips of tiles per thread. More would be wasted if the client cancels.
std::uint32_t window_rows(std::uint32_t rest, std::uint32_t chunk_rows, std::uint32_t thread_count);
// Rows that a rank gets at once: a strip of tiles per thread, or half of it if fewer rows are left for it, as much as
// it can trace while the others trace theirs. speed_part: fraction of the speed of all ranks; 0: unknown.
std::uint32_t piece_rows(std::uint32_t left_count, double speed_part, std::uint32_t rank_threads);
// Number of rows of the window that nobody has.
std::uint32_t free_rows(const RowShare& share, std::uint32_t window);
// Takes that rank's next piece; returns false if there is none. A row with more pixels than allowed is split.
bool take_piece(RowShare* share, std::uint16_t rank, const PieceLimits& limits, RowPiece* piece);
// Call when the rank has traced the piece. Returns true if its rows are thereby complete.
bool end_piece(RowShare* share, std::uint16_t rank, const RowPiece& piece);
// Takes back all rows that the rank has not completed, and no longer prefers it for others.
void take_back_rows(RowShare* share, std::uint16_t rank);

}  // namespace pocketray
