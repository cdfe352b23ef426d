// Frames whose rows several machines share. This one traces some of the rows, and of those that it traced in the last
// frame, too, only what may have changed. Which rows it traces need not be known in advance. The pixels are those of
// the frame traced whole, bit for bit.
#pragma once
#include "engine/frame.h"

namespace pocketray {

// Begins a frame after prepare_frame(), as far as settings and the memory plan allow coherence; what is kept of rows
// outside [row_begin, row_end) is given up unless nothing has changed. Ends the one before with end_shared_rows(),
// which must be called before prepare_frame(); without that call, all rows are traced whole.
void begin_shared_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end);

// Searches rows of about that many pixels for what may have changed. True when all are searched, so that rows can be
// listed and traced.
bool search_shared_rows(Renderer* renderer, std::uint32_t pixel_count_max);

// Whether the frame equals the last one that was kept, in every row of the picture; after begin_shared_rows().
bool is_shared_frame_unchanged(const Renderer& renderer);

// Pixels of the row to trace, and those of its columns from `begin` to the returned end, at least one if any is left,
// at most `pixel_count_max`.
std::uint32_t count_pixels(const Renderer& renderer, std::uint32_t row);
std::uint32_t end_of_part(const Renderer& renderer, std::uint32_t row, std::uint32_t begin,
                          std::uint32_t pixel_count_max);

// The spans to trace, until the next call: of rows, at most listed_rows_max() of them; of a part of a row.
struct SharedSpans {
  const Span* spans;
  std::uint32_t count;  // 0: none of their pixels can have changed
};
std::uint32_t listed_rows_max(const Renderer& renderer);
SharedSpans list_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end);
// Of ranges of rows in any order, no row twice; several ranges have at most kRangesRowsMax rows together:
// a server takes two rows per thread beyond the end of a run.
constexpr std::uint32_t kRangesRowsMax = 2 * kThreadCountMax;
SharedSpans list_ranges(Renderer* renderer, const RowRange* ranges, std::uint32_t range_count);
SharedSpans list_part(Renderer* renderer, std::uint32_t row, std::uint32_t begin, std::uint32_t end);

// All that was listed of these rows is traced into the image.
void finish_shared_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end);

// Keeps the rows that are finished or did not change for the next frame.
void end_shared_rows(Renderer* renderer);

}  // namespace pocketray
