// A frame in one sentence: scene → plan → accelerate → trace + shade spans. Planning was done before the first frame;
// the source decides which spans are traced, and when; showing the frame is up to the caller.
#include "engine/frame.h"

#include "base/check.h"
#include "base/limit_list.h"
#include "engine/prepare.h"

namespace pocketray {
namespace {

void list_changed_rows(const Coherence& c, FrameSpans* own) {
  const std::uint32_t row_max = row_spans_max(c.plan.width);
  own->list.spans = c.spans.data;
  own->list.span_count = own->list.done_count = 0;
  while (own->tile_row < c.tile_rows && own->list.span_count + row_max <= c.spans.count)
    own->list.span_count += list_changes(c, own->tile_row++, c.spans.data + own->list.span_count);
}

void next_spans(void* context, SpanBatch* batch) {
  History* h = &static_cast<Renderer*>(context)->history;
  SpanList* list = &h->spans.list;
  while (!h->spans.all && list->done_count == list->span_count && h->spans.tile_row < h->coherence.tile_rows)
    list_changed_rows(h->coherence, &h->spans);
  list_source(list).next(list, batch);
}

bool finish_spans(void* context, const SpanBatch& batch) {
  History* h = &static_cast<Renderer*>(context)->history;
  SpanList* list = &h->spans.list;
  if (is_followed(*h)) h->state.pixels_traced += span_pixel_count(batch.spans, batch.done_count);
  const bool is_list_done = list_source(list).finished(list, batch);
  return is_list_done && (h->spans.all || h->spans.tile_row == h->coherence.tile_rows);
}

}  // namespace

Status begin_frame(Renderer* renderer, const FrameTask& task) {
  CHECK(renderer->accel.info != nullptr && renderer->image.data != nullptr);  // it has been built
  RETURN_IF_ERROR(check_limit(Quantity::seconds, task.seconds));
  end_frame(renderer);  // while the geometry is its own
  const Clock& clock = *renderer->pace.clock;
  const std::uint64_t start = clock.now_ns();
  renderer->pace.owed_ns = 0;
  pose_scene(renderer, task.seconds);
  accelerate(renderer);
  choose_kernels(renderer);
  light_scene(renderer);
  RETURN_IF_ERROR(aim_camera(renderer));
  make_tracers(renderer);
  renderer->history.prepare_ns = clock.now_ns() - start;
  begin_history(renderer, task);
  return success();
}

SpanSource frame_source(Renderer* renderer, const std::atomic<bool>* stop, std::uint64_t deadline_ns) {
  History* h = &renderer->history;
  CHECK(h->purpose == FramePurpose::whole || h->purpose == FramePurpose::changes);
  h->spans.list.batch_spans = deadline_ns == kNoDeadline ? ~0u : 4 * kTileRows * renderer->settings.threads;
  SpanSource source = {renderer, next_spans, finish_spans};
  source.stop = stop;
  source.deadline_ns = deadline_ns;
  return source;
}

Status render_frame(Renderer* renderer, const FrameTask& task, bool* complete) {
  RETURN_IF_ERROR(begin_frame(renderer, task));
  SpanSource source = task.source;
  if (!source.next) {
    source = frame_source(renderer, task.source.stop);
    source.aov = task.source.aov;
  }
  const bool done = trace_frame(renderer, source);
  end_frame(renderer);
  if (complete) *complete = done;
  return success();
}

Status render_frame(Renderer* renderer, double seconds, Aov aov, const std::atomic<bool>* stop,
                    std::uint32_t* rows_done) {
  FrameTask task = {seconds};
  task.source.aov = aov;
  task.source.stop = stop;
  RETURN_IF_ERROR(render_frame(renderer, task));
  if (rows_done) *rows_done = renderer->history.spans.list.done_count;
  return success();
}

}  // namespace pocketray
