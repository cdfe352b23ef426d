// Frames whose rows several machines share. This one traces some of the rows, and only what may have changed in those
// that it also traced in the last frame. Which rows it traces need not be known in advance. The pixels equal those of
// the frame traced whole, bit for bit.
//
// Begin such a frame with FramePurpose::shared_rows, search it, then list and trace rows. With
// FramePurpose::shared_light all rows are listed whole.
#pragma once
#include "engine/frame.h"

namespace pocketray {

// Searches rows of about that many pixels for changes. Returns true when all are searched, so that rows can be listed
// and traced.
bool search_shared_rows(Renderer* renderer, std::uint32_t pixel_count_max);

// Returns whether every row of the frame equals the last kept frame; after begin_frame().
bool is_shared_frame_unchanged(const Renderer& renderer);

// Counts the pixels of the row to trace, and those in its columns from `begin` to the returned end: at least one if any
// is left, at most `pixel_count_max`.
std::uint32_t count_pixels(const Renderer& renderer, std::uint32_t row);
std::uint32_t end_of_part(const Renderer& renderer, std::uint32_t row, std::uint32_t begin,
                          std::uint32_t pixel_count_max);

// The spans to trace, valid until the next call: of at most listed_rows_max() rows, or of a part of a row.
struct SharedSpans {
  const Span* spans;
  std::uint32_t count;  // 0: none of their pixels can have changed
};
std::uint32_t listed_rows_max(const Renderer& renderer);
SharedSpans list_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end);
// Lists ranges of rows in any order, no row twice; several ranges have at most kRangesRowsMax rows together: a server
// takes two rows per thread beyond the end of a run.
constexpr std::uint32_t kRangesRowsMax = 2 * kThreadCountMax;
SharedSpans list_ranges(Renderer* renderer, const RowRange* ranges, std::uint32_t range_count);
SharedSpans list_part(Renderer* renderer, std::uint32_t row, std::uint32_t begin, std::uint32_t end);

// Marks these rows as finished: all that was listed of them is traced into the image.
void finish_shared_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end);

}  // namespace pocketray
