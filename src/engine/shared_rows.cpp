#include "engine/shared_rows.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

bool records(const Renderer& renderer) { return renderer.history.records; }

bool find_row(void* context, std::uint32_t thread, std::uint32_t row) {
  Renderer* renderer = static_cast<Renderer*>(context);
  find_changes(&renderer->history.coherence, row, thread, &renderer->tracers[thread].stats);
  return true;
}

}  // namespace

bool is_shared_frame_unchanged(const Renderer& renderer) {
  return records(renderer) && !renderer.history.state.whole_because && is_unchanged(renderer.history.coherence);
}

bool search_shared_rows(Renderer* renderer, std::uint32_t pixel_count_max) {
  SharedRows* rows = &renderer->history.rows;
  Coherence* c = &renderer->history.coherence;
  if (!records(*renderer) || rows->searched) return true;
  const std::uint32_t end = (rows->end + kChangeTileSide - 1) / kChangeTileSide;
  const std::uint32_t count = std::max(1u, pixel_count_max / (kChangeTileSide * c->plan.width));
  const std::uint32_t stop = std::min(end, rows->tile_row + count);
  share_items(renderer->workers, rows->tile_row, stop, find_row, renderer);
  rows->tile_row = stop;
  if (stop < end) return false;
  spread_changes(c);
  for (std::uint32_t row = rows->begin; row < rows->end; ++row)
    if (c->row_known[row]) ++rows->known_rows, rows->known_changes += count_changes(*c, row);
  clear_changes(c);
  start_recording(c, &renderer->frame, renderer->tracers);
  rows->searched = true;
  return true;
}

std::uint32_t count_pixels(const Renderer& renderer, std::uint32_t row) {
  CHECK(!records(renderer) || renderer.history.rows.searched);
  return records(renderer) ? count_changes(renderer.history.coherence, row) : renderer.settings.width;
}

std::uint32_t end_of_part(const Renderer& renderer, std::uint32_t row, std::uint32_t begin,
                          std::uint32_t pixel_count_max) {
  CHECK_LT(begin, renderer.settings.width);
  CHECK_LT(0u, pixel_count_max);
  const std::uint32_t width = renderer.settings.width;
  if (!records(renderer)) return begin + std::min(pixel_count_max, width - begin);
  std::uint32_t end = begin, count = 0;
  for (; end < width; ++end) {
    count += is_changed(renderer.history.coherence, row, end);
    if (count > pixel_count_max) break;
  }
  return end;
}

std::uint32_t listed_rows_max(const Renderer& renderer) {
  if (!records(renderer)) return renderer.settings.height;
  return static_cast<std::uint32_t>(renderer.history.coherence.spans.count / line_spans_max(renderer.settings.width));
}

SharedSpans list_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end) {
  const RowRange range = {row_begin, row_end};
  return list_ranges(renderer, &range, 1);
}

SharedSpans list_ranges(Renderer* renderer, const RowRange* ranges, std::uint32_t range_count) {
  CHECK_GT(range_count, 0u);
  std::uint32_t rows = 0, count = 0;
  for (std::uint32_t i = 0; i < range_count; ++i) {
    CHECK(ranges[i].begin < ranges[i].end && ranges[i].end <= renderer->settings.height);
    rows += ranges[i].end - ranges[i].begin;
  }
  CHECK_LE(rows, listed_rows_max(*renderer));
  const bool whole = !records(*renderer);
  if (whole && range_count == 1) return {renderer->spans.data + ranges[0].begin, rows};
  CHECK(!whole || rows <= kRangesRowsMax);
  Coherence* c = &renderer->history.coherence;
  for (std::uint32_t i = 0; i < range_count; ++i)
    for (std::uint32_t row = ranges[i].begin; row < ranges[i].end; ++row)
      if (whole)
        renderer->history.rows.parts[count++] = renderer->spans[row];
      else
        count += list_changes(*c, row, 0, c->plan.width, c->spans.data + count);
  return {whole ? renderer->history.rows.parts : c->spans.data, count};
}

SharedSpans list_part(Renderer* renderer, std::uint32_t row, std::uint32_t begin, std::uint32_t end) {
  CHECK(begin < end && end <= renderer->settings.width);
  SharedRows* rows = &renderer->history.rows;
  Coherence* c = &renderer->history.coherence;
  if (records(*renderer)) {
    const std::uint32_t count = list_changes(*c, row, begin, end, c->spans.data);
    if (count != 1) return {c->spans.data, count};
    begin = c->spans[0].column_begin, end = c->spans[0].column_end;
  }
  rows->parts[0] = row_span(row, begin, end);
  return {rows->parts, 1};
}

void finish_shared_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end) {
  CHECK(row_begin <= row_end && row_end <= renderer->settings.height);
  for (std::uint32_t row = row_begin; row < row_end; ++row) {
    renderer->history.state.pixels_traced += count_pixels(*renderer, row);
    if (renderer->history.coherence.following) renderer->history.coherence.row_traced[row] = 1;
  }
}

}  // namespace pocketray
