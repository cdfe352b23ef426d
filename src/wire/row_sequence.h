// Walks the rows of a request in the order in which a server traces and sends them.
#pragma once
#include "wire/message.h"

namespace pocketray {

// Returns whether the runs cover every row once: their lengths add up, and their places are distinct.
bool is_order(const FrameRequest& request);

// Position in a request: the remaining rows of the current run, of which the lowest is next.
struct RowSequence {
  std::uint32_t place = 0, row_begin = 0, row_end = 0;
};
inline bool has_rows(const RowSequence& sequence) { return sequence.row_begin < sequence.row_end; }
RowSequence first_rows(const FrameRequest& request);
// Skips the lowest rows of the run, at most all of it.
void pass_rows(const FrameRequest& request, std::uint32_t row_count, RowSequence* sequence);
// Rows of the run at `place` in the order.
RowRange run_at(const FrameRequest& request, std::uint32_t place);
inline std::uint32_t run_count(const FrameRequest& request) { return request.run_count > 0 ? request.run_count : 1; }
// Number of rows of the next chunk, 0 at the end. A sender may send fewer.
std::uint32_t next_chunk_rows(const FrameRequest& request, const RowSequence& sequence);

}  // namespace pocketray
