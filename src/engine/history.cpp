// How frames that trace only what may have changed since the last one begin and end.
#include "engine/history.h"

#include <algorithm>

#include "base/check.h"
#include "engine/prepare.h"
#include "engine/recolor.h"
#include "plan/plan_memory.h"
#include "plan/resolve.h"

namespace pocketray {
namespace {

bool find_row(void* context, std::uint32_t thread, std::uint32_t row) {
  Renderer* renderer = static_cast<Renderer*>(context);
  find_changes(&renderer->history.coherence, row, thread, &renderer->tracers[thread].stats);
  return true;
}

bool measure_row(void* context, std::uint32_t, std::uint32_t row) {
  Renderer* renderer = static_cast<Renderer*>(context);
  History* h = &renderer->history;
  measure_tiles(&h->coherence, renderer->frame, row, h->purpose == FramePurpose::changes && h->spans.all);
  return true;
}

bool are_all_rows_known(const Coherence& c) {
  return std::all_of(c.row_known.begin(), c.row_known.end(), [](std::uint8_t known) { return known != 0; });
}

double ms_since(std::uint64_t start) { return static_cast<double>(clock_ns() - start) * 1e-6; }

// Starts following the frame, unless coherence is not planned or rests; whole_because is the reason if all of its rows
// must be traced. Returns true if the frame is followed and can be kept.
bool begin_following(Renderer* renderer) {
  CoherenceState* state = &renderer->history.state;
  Coherence* c = &renderer->history.coherence;
  if (!state->planned) {
    state->whole_because = state->unplanned_because;
  } else if (const char* because = unfollowed_because(renderer->effects.mask)) {
    state->whole_because = because;
  } else if (!fits(*c, renderer->frame)) {
    state->whole_because = "more samples, lights or effects than memory was planned for";
  } else if (renderer->settings.coherence == CoherenceMode::automatic && rests(&state->trial)) {
    state->whole_because = state->trial.is_warming ? "the first frame" : "tracing only what changed did not pay";
  } else {
    follow_frame(c, renderer->frame, &state->whole_because);
    if (state->whole_because && state->trial.tries_again) state->whole_because = "retrying coherence";
    return true;
  }
  forget_frame(c);
  return false;
}

void begin_changes(Renderer* renderer) {
  History* h = &renderer->history;
  CoherenceState* state = &h->state;
  Coherence* c = &h->coherence;
  state->follow_ms = state->find_ms = state->keep_ms = 0;
  const std::uint64_t start = clock_ns();
  h->records = begin_following(renderer);
  h->spans.all = state->whole_because != nullptr;
  if (!h->records) return;
  state->follow_ms = ms_since(start);
  if (!h->spans.all && !(is_unchanged(*c) && are_all_rows_known(*c))) {
    const std::uint64_t found = clock_ns();
    share_items(renderer->workers, 0, c->tile_rows, find_row, renderer);
    spread_changes(c);
    clear_changes(c);
    for (const ChangeCounts& counts : c->counts) {
      state->search.moving_rays += counts.moving_rays;
      state->search.static_rays += counts.static_rays;
    }
    state->find_ms = ms_since(found);
  } else if (!h->spans.all) {
    std::fill(c->changed.begin(), c->changed.end(), 0);
  }
  start_recording(c, &renderer->frame, renderer->tracers);
}

// Drops kept rows outside the range unless nothing has changed.
void begin_rows(Renderer* renderer, RowRange range) {
  History* h = &renderer->history;
  CoherenceState* state = &h->state;
  Coherence* c = &h->coherence;
  if (range.end == 0) range.end = renderer->settings.height;
  CHECK_LT(range.begin, range.end);
  CHECK_LE(range.end, renderer->settings.height);
  h->rows = {range.begin, range.end};
  state->trial.is_cold = false;  // times are not compared
  h->records = begin_following(renderer);
  if (!h->records) {
    state->trial.was_recorded = false;
    return;
  }
  std::fill(c->changed.begin(), c->changed.end(), 0);
  if (!is_unchanged(*c)) {
    std::fill(c->row_known.begin(), c->row_known.begin() + range.begin, std::uint8_t(0));
    std::fill(c->row_known.begin() + range.end, c->row_known.end(), std::uint8_t(0));
  }
  h->rows.tile_row = range.begin / kChangeTileSide;
}

FrameKind kind_of(const History& h) {
  if (!h.spans.all) return FrameKind::coherent;
  return h.records ? FrameKind::recorded : FrameKind::plain;
}

void end_changes(Renderer* renderer) {
  History* h = &renderer->history;
  const Clock& clock = *renderer->pace.clock;
  const std::uint64_t start = clock_ns(), paced_start = clock.now_ns();
  if (!h->is_complete) return forget_frame(&h->coherence);
  if (h->records) {
    keep_frame(&h->coherence, renderer->frame);
    share_items(renderer->workers, 0, h->coherence.tile_rows, measure_row, renderer);
  }
  wait_for_pace(&renderer->pace, 0, paced_start);
  h->state.keep_ms = ms_since(start);
  h->spent_ns += clock.now_ns() - paced_start;
  weigh_frame(&h->state.trial, kind_of(*h), static_cast<double>(h->spent_ns));
}

// For CoherenceMode::automatic, weighed in pixels: a part of a frame has no comparable time. Following and searching
// cost less than a tenth of tracing the rows (coherence-report).
void weigh_rows(const SharedRows& rows, std::uint32_t width, CoherenceState* state) {
  CoherenceTrial* trial = &state->trial;
  const bool whole = state->whole_because != nullptr, in_vain = whole && trial->was_recorded;
  trial->was_recorded = whole;
  if (rows.known_rows > 0)
    rest_after(trial, 10 * rows.known_changes < 9 * std::uint64_t(rows.known_rows) * width);
  else if (in_vain)
    rest_after(trial, false);
}

// Keeps the finished and unchanged rows.
void end_rows(Renderer* renderer) {
  History* h = &renderer->history;
  Coherence* c = &h->coherence;
  if (c->following && h->rows.searched) {
    keep_rows(c, renderer->frame);
    share_items(renderer->workers, 0, c->tile_rows, measure_row, renderer);
    weigh_rows(h->rows, renderer->settings.width, &h->state);
  } else {
    forget_frame(c);  // cut short before the search was complete
  }
}

}  // namespace

void make_history(Renderer* renderer) {
  if (!renderer->history.state.planned) return;
  make_coherence(
      renderer->frame,
      coherence_plan(renderer->memory.plan.planned_for, renderer->lights.polygons.count, recolorable_count(*renderer)),
      &renderer->memory.persistent, &renderer->memory.frame, &renderer->history.coherence);
}

void begin_history(Renderer* renderer, const FrameTask& task) {
  History* h = &renderer->history;
  const Clock& clock = *renderer->pace.clock;
  const std::uint64_t start = clock.now_ns();
  h->purpose = task.purpose;
  h->is_open = true;
  h->is_complete = h->records = false;
  h->spans = FrameSpans();
  h->rows = SharedRows();
  h->spent_ns = 0;
  CHECK(!is_followed(*h) || !task.first_hits);
  if (is_followed(*h)) {
    h->state.search = ChangeCounts();
    h->state.pixels_traced = 0;
    if (task.purpose == FramePurpose::changes)
      begin_changes(renderer);
    else
      begin_rows(renderer, task.rows);
    wait_for_pace(&renderer->pace, 0, start);
    h->spent_ns = clock.now_ns() - start;
  } else if (task.first_hits) {
    forget_frame(&h->coherence);  // the caller will change the image by them
    renderer->frame.kept.first_hits = task.first_hits;
  }
  if (h->spans.all) h->spans.list = whole_frame(renderer);
}

void end_frame(Renderer* renderer) {
  History* h = &renderer->history;
  if (!h->is_open) return;
  if (h->records)
    stop_recording(*renderer->accel.info, &renderer->frame, renderer->tracers);
  else
    renderer->frame.kept.first_hits = nullptr;
  if (h->purpose == FramePurpose::changes) end_changes(renderer);
  if (h->purpose == FramePurpose::shared_rows && h->records) end_rows(renderer);
  h->is_open = h->records = false;
}

}  // namespace pocketray
