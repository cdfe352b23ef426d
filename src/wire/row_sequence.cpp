#include "wire/row_sequence.h"

#include "base/check.h"

namespace pocketray {

bool is_order(const FrameRequest& m) {
  std::uint64_t taken = 0;
  std::uint32_t rows = 0;
  for (std::uint32_t i = 0; i < m.run_count; ++i) {
    const RowRun& run = m.runs[i];
    if (run.row_count == 0 || run.place >= m.run_count || (taken >> run.place & 1) != 0) return false;
    taken |= std::uint64_t(1) << run.place;
    rows += run.row_count;
  }
  return m.run_count == 0 || rows == std::uint32_t(m.row_end - m.row_begin);
}

RowRange run_at(const FrameRequest& request, std::uint32_t place) {
  CHECK_LT(place, run_count(request));
  std::uint32_t row = request.row_begin;
  for (std::uint32_t i = 0; i < request.run_count; ++i) {
    if (request.runs[i].place == place) return {row, row + request.runs[i].row_count};
    row += request.runs[i].row_count;
  }
  return {request.row_begin, request.row_end};
}

RowSequence first_rows(const FrameRequest& request) {
  const RowRange run = run_at(request, 0);
  return {0, run.begin, run.end};
}

void pass_rows(const FrameRequest& request, std::uint32_t row_count, RowSequence* sequence) {
  CHECK_LE(row_count, sequence->row_end - sequence->row_begin);
  sequence->row_end -= row_count;
  if (has_rows(*sequence) || sequence->place + 1 >= run_count(request)) return;
  const RowRange run = run_at(request, ++sequence->place);
  sequence->row_begin = run.begin, sequence->row_end = run.end;
}

std::uint32_t next_chunk_rows(const FrameRequest& request, const RowSequence& sequence) {
  const std::uint32_t left = sequence.row_end - sequence.row_begin;
  const std::uint32_t most = request.chunk_rows < kChunkRowsLimit ? request.chunk_rows : kChunkRowsLimit;
  return left < most ? left : most;
}

}  // namespace pocketray
