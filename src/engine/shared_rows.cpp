#include "engine/shared_rows.h"

#include <algorithm>

#include "base/check.h"
#include "engine/coherent.h"

namespace pocketray {
namespace {

bool records(const Renderer& renderer) { return renderer.shared_rows.records; }

bool find_row(void* context, std::uint32_t thread, std::uint32_t row) {
  Renderer* renderer = static_cast<Renderer*>(context);
  find_changes(&renderer->coherence, row, thread, &renderer->tracers[thread].stats);
  return true;
}

bool measure_row(void* context, std::uint32_t, std::uint32_t row) {
  Renderer* renderer = static_cast<Renderer*>(context);
  measure_tiles(&renderer->coherence, renderer->frame, row, false);
  return true;
}

// For CoherenceMode::automatic, weighed in pixels: a part of a frame has no comparable time. Following and searching
// cost less than a tenth of tracing the rows (coherence-report).
void weigh(Renderer* renderer) {
  const SharedRows& rows = renderer->shared_rows;
  CoherenceTrial* trial = &renderer->coherence_state.trial;
  const bool whole = renderer->coherence_state.whole_because != nullptr, in_vain = whole && trial->was_recorded;
  trial->was_recorded = whole;
  if (rows.known_rows > 0)
    rest_after(trial, 10 * rows.known_changes < 9 * std::uint64_t(rows.known_rows) * renderer->settings.width);
  else if (in_vain)
    rest_after(trial, false);
}

}  // namespace

void begin_shared_rows(Renderer* renderer, std::uint32_t row_begin, std::uint32_t row_end) {
  CHECK_LT(row_begin, row_end);
  CHECK_LE(row_end, renderer->settings.height);
  Coherence* c = &renderer->coherence;
  CoherenceState* state = &renderer->coherence_state;
  renderer->shared_rows = {row_begin, row_end};
  state->search = ChangeCounts();
  state->pixels_traced = 0;
  SharedRows* rows = &renderer->shared_rows;
  state->trial.is_cold = false;  // times are not compared
  rows->records = begin_following(renderer);
  if (!rows->records) {
    state->trial.was_recorded = false;
    return;
  }
  std::fill(c->changed.begin(), c->changed.end(), 0);
  if (!is_unchanged(*c)) {
    std::fill(c->row_known.begin(), c->row_known.begin() + row_begin, std::uint8_t(0));
    std::fill(c->row_known.begin() + row_end, c->row_known.end(), std::uint8_t(0));
  }
  rows->tile_row = row_begin / kChangeTileSide;
}

bool is_shared_frame_unchanged(const Renderer& renderer) {
  return records(renderer) && !renderer.coherence_state.whole_because && is_unchanged(renderer.coherence);
}

bool search_shared_rows(Renderer* renderer, std::uint32_t pixel_count_max) {
  SharedRows* rows = &renderer->shared_rows;
  Coherence* c = &renderer->coherence;
  if (!rows->records || rows->searched) return true;
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
  CHECK(!records(renderer) || renderer.shared_rows.searched);
  return records(renderer) ? count_changes(renderer.coherence, row) : renderer.settings.width;
}

std::uint32_t end_of_part(const Renderer& renderer, std::uint32_t row, std::uint32_t begin,
                          std::uint32_t pixel_count_max) {
  CHECK_LT(begin, renderer.settings.width);
  CHECK_LT(0u, pixel_count_max);
  const std::uint32_t width = renderer.settings.width;
  if (!records(renderer)) return begin + std::min(pixel_count_max, width - begin);
  std::uint32_t end = begin, count = 0;
  for (; end < width; ++end) {
    count += is_changed(renderer.coherence, row, end);
    if (count > pixel_count_max) break;
  }
  return end;
}

std::uint32_t listed_rows_max(const Renderer& renderer) {
  if (!records(renderer)) return renderer.settings.height;
  return static_cast<std::uint32_t>(renderer.coherence.spans.count / line_spans_max(renderer.settings.width));
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
  Coherence* c = &renderer->coherence;
  for (std::uint32_t i = 0; i < range_count; ++i)
    for (std::uint32_t row = ranges[i].begin; row < ranges[i].end; ++row)
      if (whole)
        renderer->shared_rows.parts[count++] = renderer->spans[row];
      else
        count += list_changes(*c, row, 0, c->plan.width, c->spans.data + count);
  return {whole ? renderer->shared_rows.parts : c->spans.data, count};
}

SharedSpans list_part(Renderer* renderer, std::uint32_t row, std::uint32_t begin, std::uint32_t end) {
  CHECK(begin < end && end <= renderer->settings.width);
  SharedRows* rows = &renderer->shared_rows;
  Coherence* c = &renderer->coherence;
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
    renderer->coherence_state.pixels_traced += count_pixels(*renderer, row);
    if (renderer->coherence.following) renderer->coherence.row_traced[row] = 1;
  }
}

void end_shared_rows(Renderer* renderer) {
  Coherence* c = &renderer->coherence;
  SharedRows* rows = &renderer->shared_rows;
  if (!rows->records) return;
  if (c->following && rows->searched) {
    stop_recording(*renderer->accel_info, &renderer->frame, renderer->tracers);
    keep_rows(c, renderer->frame);
    share_items(renderer->workers, 0, c->tile_rows, measure_row, renderer);
    weigh(renderer);
  } else {
    forget_frame(c);  // cut short before the search was complete, or traced by another source
  }
  *rows = SharedRows();
}

}  // namespace pocketray
