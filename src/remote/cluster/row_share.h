// Which rank traces which rows of a request. Pure. Rows are given out in the order asked for, within a window that
// begins at the first row that is not traced. A row belongs to one rank, so that the rank can keep it for the next
// frame, and each rank first gets rows that it traced in the last one (temporal coherence).
#pragma once
#include <cstdint>
#include <vector>

#include "wire/row_sequence.h"

namespace pocketray {

// Rows of a request that lie one above the other, or columns of one row.
struct RowPiece {
  std::uint32_t row_begin = 0, row_end = 0, column_begin = 0, column_end = 0;
};
inline std::uint32_t pixel_count(const RowPiece& piece) {
  return (piece.row_end - piece.row_begin) * (piece.column_end - piece.column_begin);
}
bool operator==(const RowPiece& a, const RowPiece& b);

constexpr std::uint16_t kNoRank = 0xFFFF;

struct SharedRow {
  std::uint16_t row, rank;                    // rank: to which it belongs; kNoRank: nobody yet
  std::uint32_t columns_given, columns_done;  // from the left
};

struct RowShare {
  std::vector<SharedRow> rows;            // in the order asked for
  std::vector<std::uint16_t> places;      // of each row of the picture in that order
  std::vector<std::uint16_t> owners;      // of each row of the picture: who traced it in the last frame
  std::vector<std::uint32_t> row_pixels;  // of each row of the picture: how many pixels were traced
  std::uint32_t count = 0;                // rows of the request
  std::uint32_t front = 0;                // of them traced without a gap
  std::uint32_t width = 0;
};

// Takes the memory for pictures of at most that many rows.
void make_row_share(std::uint32_t height_max, RowShare* share);
// Begins a request. keeps_rows: ranks trace less of rows that they had in the last one.
void begin_row_share(const FrameRequest& request, bool keeps_rows, RowShare* share);

// What a rank may get at once.
struct PieceLimits {
  std::uint32_t window = 1, rows = 1, pixels = 1;  // window: rows counted from the front
  bool any = true;                                 // also rows that others had in the last frame
};
// Rows of the window that begins with the rest of a chunk: another chunk, which the ranks trace while the first is
// encoded, or two strips of tiles per thread. More would be in vain if the client cancels.
std::uint32_t window_rows(std::uint32_t rest, std::uint32_t chunk_rows, std::uint32_t thread_count);
// Rows that a rank gets at once: a strip of tiles per thread, or half of it if fewer rows are left for it, as much as
// it can trace while the others trace theirs. speed_part: of the speed of all ranks; 0: unknown.
std::uint32_t piece_rows(std::uint32_t left_count, double speed_part, std::uint32_t rank_threads);
// Rows of the window that nobody has.
std::uint32_t free_rows(const RowShare& share, std::uint32_t window);
// Gives that rank its next piece; false if there is none for it. A row of more pixels than allowed is given in parts.
bool take_piece(RowShare* share, std::uint16_t rank, const PieceLimits& limits, RowPiece* piece);
// The rank has traced the piece. True if its rows are thereby complete.
bool end_piece(RowShare* share, std::uint16_t rank, const RowPiece& piece);
// Takes back all rows that the rank has not completed, and never prefers it for others.
void take_back_rows(RowShare* share, std::uint16_t rank);

}  // namespace pocketray
