#include "split/merge.h"

#include "base/check.h"

namespace pocketray {

std::size_t merge_need(std::uint32_t row_count) { return arena_need<MergeRow>(row_count); }

Merge make_merge(std::uint32_t row_count, Arena* arena) {
  CHECK_LE(row_count, kImageSideMax);
  Merge merge;
  merge.rows = arena_array<MergeRow>(arena, row_count);
  begin_merge(&merge, 0);
  return merge;
}

void begin_merge(Merge* merge, std::uint32_t frame) {
  merge->frame = frame;
  for (MergeRow& row : merge->rows) row = MergeRow();
  merge->next_row = merge->row_count_done = 0;
}

bool take_rows(Merge* merge, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end) {
  CHECK_GT(row_count_max, 0u);
  std::uint32_t row = merge->next_row;
  while (row < merge->rows.count && merge->rows[row].state != RowState::missing) ++row;
  *row_begin = row;
  while (row < merge->rows.count && row - *row_begin < row_count_max && merge->rows[row].state == RowState::missing)
    merge->rows[row++].state = RowState::taken;
  *row_end = merge->next_row = row;
  return *row_begin < *row_end;
}

void take_row(Merge* merge, std::uint32_t row) {
  CHECK_LT(row, merge->rows.count);
  CHECK(merge->rows[row].state == RowState::missing);
  merge->rows[row].state = RowState::taken;
}

void finish_rows(Merge* merge, std::uint32_t row_begin, std::uint32_t row_end) {
  CHECK_LE(row_begin, row_end);
  CHECK_LE(row_end, merge->rows.count);
  for (std::uint32_t r = row_begin; r < row_end; ++r) {
    MergeRow* row = &merge->rows[r];
    CHECK(row->state == RowState::taken || row->state == RowState::server);
    if (row->state == RowState::taken) row->state = RowState::device, ++merge->row_count_done;
  }
}

std::uint32_t accept_rows(Merge* merge, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_end,
                          std::uint32_t server) {
  if (frame != merge->frame || row_begin > row_end || row_end > merge->rows.count) return 0;
  std::uint32_t count = 0;
  for (std::uint32_t r = row_begin; r < row_end; ++r) {
    MergeRow* row = &merge->rows[r];
    if (is_done(*row)) continue;
    *row = {RowState::server, static_cast<std::uint8_t>(server)};
    ++count;
  }
  merge->row_count_done += count;
  return count;
}

std::uint32_t discard_rows(Merge* merge, std::uint32_t server) {
  std::uint32_t count = 0;
  for (std::uint32_t r = merge->rows.count; r-- > 0;) {
    MergeRow* row = &merge->rows[r];
    if (row->state != RowState::server || row->server != server) continue;
    *row = MergeRow();
    ++count;
    if (merge->next_row > r) merge->next_row = r;
  }
  merge->row_count_done -= count;
  return count;
}

std::uint32_t count_rows(const Merge& merge, std::uint32_t server) {
  std::uint32_t count = 0;
  for (const MergeRow& row : merge.rows)
    count +=
        server == kDeviceRows ? row.state == RowState::device : row.state == RowState::server && row.server == server;
  return count;
}

}  // namespace pocketray
