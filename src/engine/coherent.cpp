#include "engine/coherent.h"

#include <algorithm>

#include "base/check.h"
#include "engine/recolor.h"
#include "plan/plan_memory.h"
#include "plan/resolve.h"

namespace pocketray {
namespace {

struct Rows {
  Renderer* renderer;
  bool all;
};

bool find_row(void* context, std::uint32_t thread, std::uint32_t row) {
  Renderer* renderer = static_cast<Rows*>(context)->renderer;
  find_changes(&renderer->coherence, row, thread, &renderer->tracers[thread].stats);
  return true;
}

bool measure_row(void* context, std::uint32_t, std::uint32_t row) {
  Rows* rows = static_cast<Rows*>(context);
  measure_tiles(&rows->renderer->coherence, rows->renderer->frame, row, rows->all);
  return true;
}

bool are_all_rows_known(const Coherence& c) {
  return std::all_of(c.row_known.begin(), c.row_known.end(), [](std::uint8_t known) { return known != 0; });
}

double ms_since(std::uint64_t start) { return static_cast<double>(clock_ns() - start) * 1e-6; }

void list_rows(Coherence* c, CoherentFrame* frame) {
  const std::uint32_t row_max = row_spans_max(c->plan.width);
  frame->list.spans = c->spans.data;
  frame->list.span_count = frame->list.done_count = 0;
  while (frame->tile_row < c->tile_rows && frame->list.span_count + row_max <= c->spans.count)
    frame->list.span_count += list_changes(*c, frame->tile_row++, c->spans.data + frame->list.span_count);
}

FrameKind kind_of(const CoherentFrame& frame) {
  if (!frame.all) return FrameKind::coherent;
  return frame.records ? FrameKind::recorded : FrameKind::plain;
}

}  // namespace

void make_coherent(Renderer* renderer) {
  if (!renderer->coherence_state.planned) return;
  make_coherence(renderer->frame,
                 coherence_plan(renderer->settings, renderer->light_point_count_max, renderer->light_polygons.count,
                                recolorable_count(*renderer)),
                 &renderer->persistent_arena, &renderer->frame_arena, &renderer->coherence);
}

bool begin_following(Renderer* renderer) {
  CoherenceState* state = &renderer->coherence_state;
  Coherence* c = &renderer->coherence;
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

void begin_coherent(Renderer* renderer, CoherentFrame* frame) {
  CoherenceState* state = &renderer->coherence_state;
  Coherence* c = &renderer->coherence;
  *frame = CoherentFrame();
  state->search = ChangeCounts();
  state->pixels_traced = 0;
  state->follow_ms = state->find_ms = state->keep_ms = 0;
  std::uint64_t start = clock_ns(), paced_start = renderer->pace.clock->now_ns();
  frame->records = begin_following(renderer);
  frame->all = state->whole_because != nullptr;
  if (frame->records) {
    state->follow_ms = ms_since(start);
    if (!frame->all && !(is_unchanged(*c) && are_all_rows_known(*c))) {
      std::uint64_t found = clock_ns();
      Rows rows = {renderer, false};
      share_items(renderer->workers, 0, c->tile_rows, find_row, &rows);
      spread_changes(c);
      clear_changes(c);
      for (const ChangeCounts& counts : c->counts) {
        state->search.moving_rays += counts.moving_rays;
        state->search.static_rays += counts.static_rays;
      }
      state->find_ms = ms_since(found);
    } else if (!frame->all) {
      std::fill(c->changed.begin(), c->changed.end(), 0);
    }
    start_recording(c, &renderer->frame, renderer->tracers);
  }
  wait_for_pace(&renderer->pace, 0, paced_start);
  frame->spent_ns = clock_ns() - start;
  if (frame->all) frame->list = whole_frame(renderer);
}

void finish_coherent(Renderer* renderer, CoherentFrame* frame) {
  Coherence* c = &renderer->coherence;
  std::uint64_t start = clock_ns(), paced_start = renderer->pace.clock->now_ns();
  stop_recording(*renderer->accel_info, &renderer->frame, renderer->tracers);
  if (frame->records) {
    Rows rows = {renderer, frame->all};
    keep_frame(c, renderer->frame);
    share_items(renderer->workers, 0, c->tile_rows, measure_row, &rows);
  }
  wait_for_pace(&renderer->pace, 0, paced_start);
  renderer->coherence_state.keep_ms = ms_since(start);
  frame->spent_ns += clock_ns() - start;
  weigh_frame(&renderer->coherence_state.trial, kind_of(*frame), static_cast<double>(frame->spent_ns));
}

bool advance_coherent(Renderer* renderer, std::uint64_t deadline_ns, const std::atomic<bool>* stop,
                      CoherentFrame* frame) {
  CoherenceState* state = &renderer->coherence_state;
  std::uint64_t start = clock_ns();
  bool complete = false;
  for (;;) {
    if (!frame->all && frame->list.done_count == frame->list.span_count) list_rows(&renderer->coherence, frame);
    const std::uint32_t before = frame->list.done_count;
    if (deadline_ns != kNoDeadline) frame->list.batch_spans = 4 * kTileRows * renderer->settings.threads;
    SpanSource source = list_source(&frame->list);
    source.is_coherent = true;
    source.deadline_ns = deadline_ns;
    source.stop = stop;
    if (frame->list.done_count < frame->list.span_count && !trace_frame(renderer, source)) {
      state->pixels_traced += span_pixel_count(frame->list.spans + before, frame->list.done_count - before);
      break;
    }
    state->pixels_traced += span_pixel_count(frame->list.spans + before, frame->list.done_count - before);
    complete = frame->all || frame->tile_row == renderer->coherence.tile_rows;
    if (complete) break;
  }
  frame->spent_ns += clock_ns() - start;
  if (complete) finish_coherent(renderer, frame);
  return complete;
}

Status render_coherent(Renderer* renderer, double seconds, const std::atomic<bool>* stop, bool* complete) {
  RETURN_IF_ERROR(prepare_frame(renderer, seconds));
  const Clock& clock = *renderer->pace.clock;
  std::uint64_t start = clock.now_ns();
  CoherentFrame frame;
  begin_coherent(renderer, &frame);
  bool done = advance_coherent(renderer, kNoDeadline, stop, &frame);
  if (!done) stop_recording(*renderer->accel_info, &renderer->frame, renderer->tracers);
  renderer->timings.trace_ms = static_cast<double>(clock.now_ns() - start) * 1e-6;
  if (complete) *complete = done;
  return success();
}

}  // namespace pocketray
