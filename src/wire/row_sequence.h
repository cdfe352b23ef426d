// Walks the rows of a request in the order in which a server traces and sends them.
#pragma once
#include "wire/message.h"

namespace pocketray {

// Whether the runs have every row once: they are as long as the rows together, and each has a place of its own.
bool is_order(const FrameRequest& request);

// The rows of a request in their order: those of the current run that are left. The lowest of them is next.
struct RowSequence {
  std::uint32_t place = 0, row_begin = 0, row_end = 0;
};
inline bool has_rows(const RowSequence& sequence) { return sequence.row_begin < sequence.row_end; }
RowSequence first_rows(const FrameRequest& request);
// Passes the lowest rows of the run, at most all of it.
void pass_rows(const FrameRequest& request, std::uint32_t row_count, RowSequence* sequence);
// Rows of the run whose turn is the `place`-th; the number of runs.
RowRange run_at(const FrameRequest& request, std::uint32_t place);
inline std::uint32_t run_count(const FrameRequest& request) { return request.run_count > 0 ? request.run_count : 1; }
// Rows of the next chunk, 0 at the end. A sender may use fewer.
std::uint32_t next_chunk_rows(const FrameRequest& request, const RowSequence& sequence);

}  // namespace pocketray
